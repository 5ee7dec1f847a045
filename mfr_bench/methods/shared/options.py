"""Parameters that several families share, each declared once over shared shader code."""

from __future__ import annotations

from ..spec import ON_OFF, SAMPLE_STENCIL, Param, when

K = Param("k", 8, "fragments kept per pixel, the nearest", low=1, high=1024)
BOUND = Param("bound", "auto", "how shaders know k as the bound of loops over the slots of a pixel: as a uniform, or "
              "as a constant, by which a compiler may unroll them; auto: a uniform under a lock, else a constant",
              choices=("auto", "uniform", "constant"))
SYNC = Param("sync", "spin", "mutual exclusion per pixel: spin lock with a semaphore; fragment shader interlock in any "
             "order, or in that of submission, as GL_INTEL_fragment_shader_ordering always has it; or none, to see "
             "what it is there for", choices=("spin", "interlock", "ordered", "none"),
             needs=dict.fromkeys(("interlock", "ordered"), "fragment_shader_interlock"),
             weakens={"none": "fragments of a pixel in flight at once lose each other's changes"})
TIES_OF_INSERTION = ("kept, in order of arrival, but each nearer fragment that comes later puts the first of them "
                     "behind the others")
LOCK = "with sync: spin a semaphore, one word per pixel"
CULLING = Param("culling", "on", "refuse fragments beyond the furthest kept before the critical section",
                choices=ON_OFF)
SORT = Param("sort", "auto", "sort of the resolve; hybrid: insertion up to 16 fragments, shell above; lplus: batches "
             "of the nearest 32; register: blocks of at most 32 in registers, merged; auto: the fastest that was "
             "measured for as many fragments as a pixel may have (docs/fairness.md)",
             choices=("auto", "insertion", "shell", "hybrid", "bubble", "lplus", "register"))
LOCAL_ARRAY = Param("local_array", 0, "fragments that the resolve's local array holds; 0: as many as a pixel may need, "
                    "with lplus 32; a pixel with more loses them, counted", low=0, high=4096)
BMA = Param("bma", "off", "backwards memory allocation: one resolve for each power of two of fragments, so that a "
            "shallow pixel does not pay for the deepest one's local array", choices=ON_OFF)
STAGE = Param("resolve", "fragment", "the resolve as a full-screen draw, or as a compute shader that writes the image",
              choices=("fragment", "compute"))
STOP_OPACITY = Param("stop_opacity", 1.0, "opacity at which a pixel's compositing, or its peeling, ends; 1: never",
                     real=True, low=0, high=1, closed=True,
                     asks={"0-0.999999": "blended"},
                     weakens={"0-0.999999": "fragments behind an opacity of `stop_opacity` may be missing, an error of "
                              "up to 1 - stop_opacity"}, error="1 - stop_opacity")
ACCUMULATE = Param(
    "accumulate", "float32", "the colour that fragments are added to, front to back: 32-bit floats; the same with what "
    "each addition rounds away carried along; rounded after each fragment to 16-bit floats, or to 8 bits",
    choices=("float32", "compensated", "float16", "unorm8"),
    asks=dict.fromkeys(("compensated", "float16", "unorm8"), "blended"),
    weakens={"float16": "rounded to 11 bits after each fragment: a layer behind an opacity of 0.9995 is lost",
             "unorm8": "rounded to 8 bits after each fragment, an error of up to n/510"})
# Options of `resolve`; a method may offer some or all.
RESOLVE_OPTIONS = (SORT, LOCAL_ARRAY, BMA, STAGE, ACCUMULATE, STOP_OPACITY)
REUSE_COUNT = Param("reuse_count", "off", "fragments are counted, and ranges made, in every frame (off), or in the "
                    "first frame of a scene for all that follow until it changes (on): frames of a static scene are "
                    "then timed without their count", choices=ON_OFF)
ATOMIC64 = Param("atomic64", "native", "64-bit atomics: the device's own, or emulated by 32-bit ones",
                 choices=("native", "emulated"), needs={"native": "shader_atomic_int64"})
EARLY_CULLING = Param("early_culling", "off", "drop fragments behind an accumulated opacity of `culling_opacity`",
                      choices=ON_OFF, asks={"on": "blended"},
                      weakens={"on": "fragments behind an opacity of `culling_opacity` may be missing, an error of up "
                                     "to 1 - culling_opacity"}, error="1 - culling_opacity")
CULLING_OPACITY = Param("culling_opacity", 0.95, "opacity behind which early culling drops fragments; 0.95 in "
                        "gpupro5_ch1", real=True, low=0, high=1, closed=True, acts=when("early_culling", "on"))
PEELED = Param("layers", 0, "layers peeled at most; 0: all of them", low=0, high=4096)
PAYLOAD = Param("payload", "rgba8", "stored colour, straight: 8 bits a channel; 16-bit floats in two words, in "
                "units of 1/255, which hold an 8-bit colour without error; or two channels, luminance and a blend of "
                "the scene's two base colours, with alpha 24 bits in a word",
                choices=("rgba8", "rgba16f", "two_channel"), asks={"two_channel": "blended"},
                weakens={"two_channel": "hues come from one plane through the scene's colours; luminance is kept"})

MULTISAMPLING = Param(
    "multisampling", "on", "while fragments are routed. off, as in the source: a fragment covers all samples, whose "
    "stencils GL lets a device test by one of them; on: it covers those that it covers, with depths of any "
    "place in the pixel, right where primitives are flat and meet no pixel but at its edges", choices=ON_OFF,
    needs={"off": SAMPLE_STENCIL}, asks={"on": "flat"})
OCCUPANCY = Param("occupancy", 0, "intervals of the occupancy map, by which fragments beyond the k-th are discarded "
                  "before the store, by early z where the store has no depth or stencil test of its own; 0: none",
                  of=(0, 32, 64, 128), low=0, high=128)
OCCUPANCY_BOUNDS = Param("occupancy_bounds", "geometry", "the depths between which the intervals lie: those of the "
                         "pixel's fragments, for a further geometry pass, or those of a box around the scene, whose "
                         "rectangle is drawn, as in the source", choices=("geometry", "box"),
                         acts=when("occupancy", *(d for d in OCCUPANCY.of if d)))
