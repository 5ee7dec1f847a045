"""Every mistake is a line: file, line, key, what is allowed, the nearest name; all of them at once."""

import pytest

from .conftest import GOOD

SCENE = "scene: {size: [64, 48], depth_complexity: 32}"


def scene(extra):
    return GOOD.replace(SCENE, SCENE[:-1] + f", {extra}}}")


def methods(entries):
    return GOOD.replace("[kplus-array, ab-array]", entries)


def sweep(axes):
    return GOOD.replace("{k: [4, 16]}", axes)


ONE_LINE = [
    # syntax and shape
    ("name: [a", "F:1: not valid YAML: "),
    ("name: a\n\tb: c\n", "F:2: not valid YAML: "),
    ("name: a\x01b\n", "F:1: not valid YAML: special characters are not allowed"),
    ("", "F:1: nothing is not a config; allowed: a mapping with name, title"),
    ("- a\n", "F:1: ['a'] is not a config; allowed: a mapping"),
    ("a: 1\n---\nb: 2\n", "F:2: not valid YAML: expected a single document"),
    (GOOD + "title: !python/name:os.system x\n", "F:8: title: could not determine a constructor"),
    (GOOD + "title: a\ntitle: b\n", "F:9: title: the key is repeated, first on line 8"),
    (GOOD + "params: {? [a] : b}\n", "F:8: params: a key must be a single word"),
    ("a: " + "[" * 100 + "]" * 100, "nested or repeated too deeply"),
    ("a: " + "[" * 5000 + "]" * 5000, "nested or repeated too deeply"),
    ("a: &a [*a]", "nested or repeated too deeply"),
    # keys
    (GOOD.replace("name: good\n", ""), "F:1: name: missing; allowed: letters"),
    (GOOD.replace("good", "a/b"), "F:1: name: 'a/b' is not allowed; allowed: letters"),
    (GOOD.replace("good", "..", 1), "F:1: name: '..' is not allowed"),
    (GOOD + "titel: x\n", "F:8: titel: unknown key; allowed: name, title"),
    (GOOD + "titel: x\n", "; nearest: 'title'"),
    (scene("sede: 3"), "F:2: scene.sede: unknown key; nearest: 'seed'; allowed: kind, size"),
    (GOOD.replace("size: [64, 48], ", ""), "F:2: scene.size: missing; allowed: two whole numbers"),
    (GOOD.replace(", depth_complexity: 32", ""), "F:2: scene.depth_complexity: missing; allowed: a whole number"),
    (GOOD.replace("methods: [kplus-array, ab-array]\n", ""), "F:1: methods: missing; allowed: a list"),
    (GOOD.replace(SCENE, "scene: 5"),
     "F:2: scene: 5 is not allowed; allowed: a mapping with size, depth_complexity and any of "),
    (GOOD.replace(SCENE, "scene:"), "F:2: scene: no value is given; allowed: a mapping with size, depth_complexity"),
    (GOOD.replace("name: good", "name: good\nsource: {papr: x}"), "F:2: source.papr: unknown key; allowed: paper, "),
    (GOOD + "source: {figure: 6}\n", "F:8: source.figure: 6 is not allowed; allowed: text"),
    # scene values
    (GOOD.replace("[64, 48]", "[64, 16385]"), "F:2: scene.size: [64, 16385] is not allowed; allowed: two whole"),
    (GOOD.replace("[64, 48]", "[0, 48]"), "from 1 to 16384"),
    (GOOD.replace("[64, 48]", "[64]"), "F:2: scene.size: [64] is not allowed"),
    (GOOD.replace("[64, 48]", '["64", 48]'), "F:2: scene.size: ['64', 48] is not allowed"),
    (GOOD.replace("[64, 48]", "[64.0, 48]"), "F:2: scene.size: [64.0, 48] is not allowed"),
    (GOOD.replace(" 32", " -1"), "F:2: scene.depth_complexity: -1 is not allowed"),
    (GOOD.replace(" 32", " true"), "F:2: scene.depth_complexity: True is not allowed"),
    (GOOD.replace(" 32", " 5000000"), "F:2: scene.depth_complexity: 5000000 is not allowed"),
    (scene("pixel_density: 0"), "F:2: scene.pixel_density: 0 is not allowed; allowed: a number above 0, up to 1"),
    (scene("pixel_density: 1.01"), "F:2: scene.pixel_density: 1.01 is not allowed"),
    (scene("pixel_density: .nan"), "F:2: scene.pixel_density: nan is not allowed"),
    (scene("pixel_density: -.inf"), "F:2: scene.pixel_density: -inf is not allowed"),
    (scene("fragment_probability: 0"), "F:2: scene.fragment_probability: 0 is not allowed"),
    (scene("alpha: -0.1"), "F:2: scene.alpha: -0.1 is not allowed; allowed: a number from 0 to 1, or two"),
    (scene("depth_copies: 0"), "F:2: scene.depth_copies: 0 is not allowed; allowed: a whole number from 1 to 16384"),
    (scene("overhang: 16777217"), "F:2: scene.overhang: 16777217 is not allowed; allowed: pixels from 0 to 16777216"),
    (scene("overhang: 16777215").replace("[64, 48]", "[64, 2]"),
     ("F:2: scene.overhang: an overhang of 16777215 beyond a viewport whose shorter side has 2 pixels, which float32 "
      "cannot clip; allowed: up to 16777214")),
    (scene("overhang: 8388608").replace("[64, 48]", "[1, 48]"),
     "a viewport whose shorter side has 1 pixel, which float32 cannot clip; allowed: up to 8388607"),
    (scene("depth_at: 0.5"), ("F:2: scene.depth_at: 32 quads in steps of 2^-4 about 0.5 leave the depth range; "
                             "allowed: smaller steps or fewer quads")),
    (scene("depth_at: 1, depth_gap_log2: -25"),
     "F:2: scene.depth_gap_log2: 32 quads in steps of 2^-25 about 1 are finer than a float32 there; allowed: larger"),
    (scene("alpha: 1.5"), "F:2: scene.alpha: 1.5 is not allowed"),
    (scene("alpha: yes"), "F:2: scene.alpha: True is not allowed"),
    (scene("alpha: [0.6, 0.1]"), "F:2: scene.alpha: [0.6, 0.1] is not allowed"),
    (scene("alpha: [0.6, .nan]"), "F:2: scene.alpha: [0.6, nan] is not allowed"),
    (scene("seed: -1"), "F:2: scene.seed: -1 is not allowed; allowed: a whole number from 0 to 4294967295"),
    (scene("seed: 4294967296"), "F:2: scene.seed: 4294967296 is not allowed"),
    (scene("layout: blok"), "allowed: block | tiles | random | mixed; nearest: 'block'"),
    (scene("order: front-to-back"), "nearest: 'front_to_back'"),
    (scene("animate: 1"), "F:2: scene.animate: 1 is not allowed; allowed: true | false"),
    (scene("quad_size: [4, 4]"),
     "F:2: scene.quad_size: quad_size has no use in layout block; allowed: with layout random"),
    (scene("mean_depth: 5"),
     "F:2: scene.mean_depth: mean_depth has no use in layout block; allowed: with layout mixed, or"),
    (scene("layout: mixed, mean_depth: 0.5"), "F:2: scene.mean_depth: 0.5 is not allowed; allowed: a number from 1"),
    (scene("layout: mixed, mean_depth: 33"),
     "F:2: scene.mean_depth: a mean_depth of 33 under a maximum of 32; allowed in"),
    (scene("kind: temple, mean_depth: 21"), "allowed in kind temple: up to 20.8"),
    (scene("kind: hairbal"),
     "quads | fragments | hairball | histogram | mesh | needles | outside | strands | temple; nearest: 'hairball'"),
    (scene("kind: needles, layout: tiles"),
     "F:2: scene.layout: layout has no use in kind needles; allowed: with kind quads"),
    (scene("kind: hairball, slant: 0.5"),
     "F:2: scene.slant: slant has no use in kind hairball; allowed: with kind quads"),
    (scene("slant: 1.5"), "F:2: scene.slant: 1.5 is not allowed; allowed: a number from 0 to 1"),
    (scene("kind: hairball, depth_copies: 2"),
     "F:2: scene.depth_copies: depth_copies has no use in kind hairball; allowed: with"),
    (scene("slant: 0.5, overhang: 2"),
     "F:2: scene.overhang: overhang has no use but for quads without slant; allowed: its default"),
    (scene("colours: hues-0"),
     "F:2: scene.colours: 'hues-0' is not allowed; allowed: any | plane | grass | rock | sand | hues-N"),
    (GOOD.replace("[64, 48], depth_complexity: 32", "[16384, 16384], depth_complexity: 17, layout: tiles"),
     "F:2: scene.depth_complexity: 4456448 quads in layout tiles; allowed: at most 4194304"),
    (GOOD.replace("32", "1000, layout: random, quad_size: [1, 1], size: [99, 99]").replace("size: [64, 48], ", ""),
     "9801000 quads in layout random"),
    # measurement
    (GOOD + "measure: {min_samples: '8'}\n", "F:8: measure.min_samples: '8' is not allowed"),
    (GOOD + "measure: {min_samples: 50, max_samples: 20}\n", "F:8: measure.max_samples: 50 to 20 samples"),
    (GOOD + "measure: {time_limit_s: .inf}\n", "F:8: measure.time_limit_s: inf is not allowed; allowed: seconds"),
    (GOOD + "measure:\n", "F:8: measure: no value is given; allowed: a mapping with target_rel_ci"),
    # methods
    (methods("[]"), "F:3: methods: [] is not allowed; allowed: a list of at least one method"),
    (methods("[kplus-aray]"), "F:3: methods[0]: unknown method 'kplus-aray'; allowed: floor, ab-array"),
    (methods("[kplus-aray]"), "; nearest: 'kplus-array'"),
    (methods("[kplus-array, 7]"),
     "F:3: methods[1]: 7 is not allowed; allowed: a method's id, 'all', or a mapping with id"),
    (methods("[kplus-array, {k: 7}]"), "F:3: methods[1]: {'k': 7} is not allowed"),
    (methods("[{id: kplus-array, cullin: off}]"), "F:3: methods[0].cullin: unknown parameter of kplus-array; "),
    (methods("[{id: kplus-array, cullin: off}]"), "; allowed: id, label, k, culling, sync; nearest: 'culling'"),
    (methods("[kplus-array, {id: ab-array, k: 8}]"), "F:3: methods[1].k: unknown parameter of ab-array; allowed: id, "),
    (methods("[{id: kplus-array, culling: maybe}]"), "F:3: methods[0].culling: 'maybe' is not allowed; allowed: "),
    (methods("[{id: kplus-array, label: ''}]"), "F:3: methods[0].label: '' is not allowed; allowed: text"),
    (methods("[kplus-array, {id: kplus-array, culling: off}]"),
     "F:3: methods[1]: the label 'K+B-Array' is also that of methods[0]; allowed: a label of its own"),
    (methods("[kplus-array, {id: kplus-heap, label: K+B-Array}]"), "F:3: methods[1]: the label 'K+B-Array' is also"),
    # parameters and axes
    (GOOD + "params: {sink: spin}\n", "F:8: params.sink: no listed method has this parameter; allowed: "),
    (GOOD + "params: {sink: spin}\n", "; allowed: k, culling, sync, r; nearest: 'sync'"),
    (GOOD + "params: {load_factor: 0.5}\n", "F:8: params.load_factor: no listed method has this parameter"),
    (GOOD + "params: {k: 0}\n", "F:8: params.k: 0 is not allowed; allowed: a whole number from 1 to 1024"),
    (GOOD + "params: {k: 8.0}\n", "F:8: params.k: 8.0 is not allowed"),
    (GOOD + "params: 5\n", "F:8: params: 5 is not allowed; allowed: a mapping of parameters to values, such as {k: "),
    (sweep("[]"), "F:4: sweep: [] is not allowed; allowed: a mapping of keys to lists of values, such as {k: [4, 8]}"),
    (sweep(""), "F:4: sweep: no value is given; allowed: a mapping of keys to lists of values"),
    (GOOD + "zip: 3\n", "F:8: zip: 3 is not allowed; allowed: a mapping of keys to lists of values"),
    (GOOD.replace("x: k, y: time_ms", "x: scene.seed, y: time_ms"),
     "F:5: figures[0].x: nothing sweeps scene.seed; allowed: a list of values for it in sweep or zip, or a"),
    (methods("[kplus-array, {id: open-post, load_factor: 1.0}]"), "F:3: methods[1].load_factor: 1.0 is not allowed; "),
    (methods("[kplus-array, {id: open-post, load_factor: 0}]"), "0 is not allowed; allowed: a number between 0 and 1"),
    (methods("[kplus-array, {id: open-post, load_factor: .nan}]"), "F:3: methods[1].load_factor: nan is not allowed"),
    (methods("[kplus-array, {id: open-post, load_factor: yes}]"), "F:3: methods[1].load_factor: True is not allowed"),
    (methods("[kplus-array, kb-small]") + "params: {k: 17}\n",
     "F:8: params.k: kb-small: 17 is not allowed; allowed: a"),
    (sweep("{k: []}"), "F:4: sweep.k: a sweep over nothing; allowed: a list of at least one value"),
    (sweep("{k: 4}"), "F:4: sweep.k: 4 is not allowed; allowed: a list of values"),
    (sweep("{k: [4, 0]}"), "F:4: sweep.k[1]: 0 is not allowed"),
    (sweep("{k: [1], pixel_density: [1]}"), "F:4: sweep.pixel_density: nothing has this key to sweep; "),
    (sweep("{k: [1], pixel_density: [1]}"), "; nearest: 'scene.pixel_density'; allowed: k, "),
    (sweep("{k: [1], scene.pixel_density: [.5, 2]}"), "F:4: sweep.scene.pixel_density[1]: 2 is not allowed; allowed: "),
    (sweep("{k: [1], scene.alpha: [[0.5, 0.1]]}"), "F:4: sweep.scene.alpha[0]: [0.5, 0.1] is not allowed"),
    (sweep("{k: [1], scene.quad_size: [[1, 1]]}"), "F:4: sweep.scene.quad_size: quad_size has no use in layout block"),
    (sweep("{k: [1]}") + "zip: {k: [1]}\n", "F:8: zip.k: already an axis of sweep; allowed: one of the two"),
    (GOOD + "zip: {scene.seed: [1, 2], sync: [spin]}\n",
     "F:8: zip: lists of unequal length: scene.seed has 2, sync has 1; "),
    (sweep(f"{{k: {list(range(1, 501))}, scene.seed: {list(range(101))}}}"),
     "F:4: sweep: 101000 cells; allowed: at most 100000"),
    (GOOD.replace("sweep: {k: [4, 16]}", "params: {r: 2}").replace("x: k", "x: r").replace(", sweep.k: [2]", ""),
     "F:4: params.r: no k for n = r·k; allowed: k in params, sweep"),
    (GOOD + "params: {r: 0}\n", "F:8: params.r: 0 is not allowed; allowed: a whole number from 1 to 1024"),
    (sweep("{k: [1], scene.depth_complexity: [1]}") + "params: {r: 1}\n", "F:8: params.r: the sweep of scene.depth"),
    # figures
    (GOOD.replace("lines", "linse"), "F:5: figures[0].kind: 'linse' is not allowed; allowed: bars | breaking"),
    (GOOD.replace("time_ms", "tme_ms"),
     "F:5: figures[0].y: unknown column 'tme_ms'; nearest: 'time_ms'; allowed: fragments"),
    (GOOD.replace("time_ms", "tme_ms"), "; nearest: 'time_ms'"),
    (GOOD.replace("x: k", "x: kk"), "F:5: figures[0].x: unknown column 'kk'; nearest: 'k'; allowed: k, "),
    (GOOD.replace("x: k", "x: load_factor"), "F:5: figures[0].x: unknown column 'load_factor'"),
    (GOOD.replace("lines, x: k, y: time_ms", "stacked_passes, x: k, y: memory_bytes"), "allowed: time_ms, share"),
    (GOOD.replace("x: k,", ""), "F:5: figures[0].x: missing; allowed: text"),
    (GOOD.replace("lines, x: k", "pareto, x: k, y: rmse").replace(", y: time_ms", ""),
     "F:5: figures[0].x: unknown column 'k'; allowed: time_ms, memory_bytes, memory_mib"),
    (GOOD.replace("lines, x: k", "pareto, x: time_ms"),
     "F:5: figures[0].y: unknown column 'time_ms'; allowed: rmse, flip, max_error_all, wrong_pixels_all"),
    (GOOD.replace("lines, x: k, y: time_ms", "pareto, x: time_ms"), "F:5: figures[0].y: missing; allowed: rmse, flip"),
    (GOOD.replace("x: k", "x: k, log: z"), "F:5: figures[0].log: 'z' is not allowed; allowed: x | y | xy"),
    (GOOD.replace("x: k", "x: k, colour: red"), "F:5: figures[0].colour: unknown key; allowed: kind, x, y, title"),
    (GOOD.replace("x: k", "x: k, methods: [K+B-Aray]"), "F:5: figures[0].methods[0]: no method has the label 'K+B-"),
    (GOOD.replace("x: k", "x: k, methods: [K+B-Aray]"), "; allowed: K+B-Array, AB_Array; nearest: 'K+B-Array'"),
    (GOOD.replace("x: k", "x: k, methods: [A, B, AB_Array]"),
     "F:5: figures[0].methods: no method has any of the labels 'A', 'B'; allowed: K+B-Array, AB_Array"),
    # profiles
    (GOOD.replace("[16, 16]", "[16]"), "F:7: profiles.smoke.scene.size: [16] is not allowed; allowed: two whole"),
    (GOOD.replace("scene.size: [16", "scene.sise: [16"),
     "F:7: profiles.smoke.scene.sise: unknown key; nearest: 'size'; allowed: kind"),
    (GOOD.replace("scene.size: [16", "foo: [16"), "F:7: profiles.smoke.foo: unknown key; allowed: a key of the config"),
    (GOOD.replace("sweep.k: [2]", "sweep.k: []"), "F:7: profiles.smoke.sweep.k: a sweep over nothing"),
    (GOOD.replace("sweep.k: [2]", "sweep.k: [2, 0]"), "F:7: profiles.smoke.sweep.k[1]: 0 is not allowed"),
    (GOOD.replace("{scene.size: [16, 16], sweep.k: [2]}", "5"), "F:7: profiles.smoke: 5 is not allowed; allowed: a"),
    (GOOD.replace("sweep.k: [2]", "zip.scene.seed: [1, 2]") + "zip: {sync: [spin]}\n",
     "F:7: profiles.smoke: zip: lists of unequal length"),
    (GOOD.replace("sweep.k: [2]", "methods: [open-post]"), "F:7: profiles.smoke: sweep.k: nothing has this key"),
]


@pytest.mark.parametrize(("text", "message"), ONE_LINE, ids=[f"{i}-{m[:40]}" for i, (_, m) in enumerate(ONE_LINE)])
def test_a_mistake_is_one_line(mistakes, text, message):
    lines = mistakes(text)
    assert any(message in line for line in lines), lines
    assert all("\n" not in line and line.startswith("F:") for line in lines)
    follow_ups = ("profiles.smoke: ", "sweep.k: nothing has", "figures[0].x: unknown", "figures[0].methods[0]")
    assert len([line for line in lines if not any(f in line for f in follow_ups)]) <= 1, lines


@pytest.mark.parametrize("written", ["{}", "[]", "3", ""])
def test_methods_that_are_no_list_are_one_mistake_however_many_labels_figures_name(mistakes, written):
    """Each label of each figure was said to be that of no method, with nothing allowed."""
    lines = mistakes(methods(written).replace("x: k", "x: k, methods: [K+B-Array, AB_Array]"))
    said = "no value is given" if not written else f"{written} is not allowed"
    assert [line for line in lines if "methods" in line] == [
        f"F:3: methods: {said}; allowed: a list of at least one method"]


def test_all_mistakes_come_at_once_in_the_order_of_the_file(mistakes):
    lines = mistakes("""\
name: a
scene: {size: [0, 1], pixel_density: 2, alpha: [0.6, 0.1], depth_complexity: 1}
params: {culling: perhaps}
methods: [kplus-array, kplus-hep]
sweep: {k: [], scene.seed: [1.5]}
measure: {min_samples: 9, max_samples: 2}
figures: [{kind: pie, x: k}]
profiles:
  smoke: {sweep.k: [-1]}
  other: {scene.kind: meshes}
""", overrides=["k=0", "kk", "foo=1"])
    where = [line.split(": ")[0] + " " + line.split(": ")[1] for line in lines]
    assert where == ["F:2 scene.size", "F:2 scene.pixel_density", "F:2 scene.alpha", "F:3 params.culling",
                     "F:4 methods[1]", "F:5 sweep.k", "F:5 sweep.scene.seed[0]", "F:6 measure.max_samples",
                     "F:7 figures[0].kind", "F:9 profiles.smoke.sweep.k[0]", "F:10 profiles.other.scene.kind",
                     "--set kk not a setting; allowed", "--set foo unknown key; allowed",
                     "--set k 0 is not allowed; allowed"]


def test_a_mistake_is_told_once_however_many_profiles_there_are(mistakes):
    text = GOOD.replace("lines", "linse") + "  a: {scene.seed: 2}\n  b: {scene.seed: 3}\n"
    assert len(mistakes(text, "a", ["scene.seed=4"])) == 1


@pytest.mark.parametrize(("override", "message"), [
    ("k8", "--set k8: not a setting; allowed: KEY=VALUE, such as k=8"),
    ("=8", "--set =8: not a setting; allowed: KEY=VALUE, such as k=8"),
    ("k=", "--set k: no value is given; allowed: a whole number from 1 to 1024"),
    ("k=eight", "--set k: 'eight' is not allowed"),
    ("kk=8", "--set kk: unknown key; allowed: a key of the config, dotted (scene.size), or a parameter; nearest: 'k'"),
    ("scene.size=[1", "--set scene.size: not valid YAML"),
    ("scene.size=[1, 0]", "--set scene.size: [1, 0] is not allowed"),
    ("scene.sise=[1, 1]", "--set scene.sise: unknown key; nearest: 'size'; allowed: kind, size"),
    ("scene={size: [1, 1]}", "--set scene.depth_complexity: missing"),
    ("sweep.k=[1, x]", "--set sweep.k[1]: 'x' is not allowed"),
    ("methods=[kplus-aray]", "--set methods[0]: unknown method 'kplus-aray'"),
    ("profiles={}", "--set profiles: unknown key"),
    ("load_factor=0.5", "--set load_factor: no listed method has this parameter"),
])
def test_a_bad_override_is_one_line(mistakes, override, message):
    lines = mistakes(overrides=[override])
    assert lines[0].startswith(message) or any(line.startswith(message) for line in lines)
    assert not [line for line in lines if not line.startswith(("--set", "F:4", "F:5"))]


def test_a_profile_that_the_file_lacks(mistakes):
    assert mistakes(profile="smok") == ["F:6: profiles: no profile 'smok'; allowed: smoke; nearest: 'smoke'"]
    text = GOOD[:GOOD.index("profiles")]
    assert mistakes(text, profile="smoke") == ["F:1: profiles: no profile 'smoke'; allowed: none; leave out --profile"]
