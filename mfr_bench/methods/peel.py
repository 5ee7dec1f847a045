"""Depth peeling: memory-bounded, exact, one or more geometry passes per layer.

The papers give no words per pixel for these; `words` counts the textures that the sources describe, at
the float precision that exactness asks of them here.

peel-bucket composites the fragments that it peels from the front and from the back of a bucket at once, so that
memory does not grow with the scene: 8 words for both colours of a bucket, 2 for its edges and 2 for those to come,
2 for the colours just peeled.

peel-srab takes fragments in order of arrival, so all must be stored until they are sorted. Its source keeps the
targets of all passes, 2 words per sample, and 1 word per sample of depth and stencil. Here each pass copies its
targets into an array (2n words, 2 words per sample more) and notes for each sample the primitive that it came
from (1 word per sample), for each pixel where the next pass resumes and how many fragments it has (2 words). The
source moves on by the stencil's starting value instead, which ends at 254 fragments: a stencil has 8 bits.
"""

from __future__ import annotations

from dataclasses import replace

from .shared import (
    ARRIVALS,
    CLEAR_IMAGE,
    CLEARED,
    COLLECTED,
    IN_ORDER,
    MULTISAMPLING,
    PEELED,
    RESOLVE_OPTIONS,
    RESUME,
    STOP_OPACITY,
    STORED,
    clear,
    collected,
    peeling,
    resolve_collected,
    routed_targets,
)
from .shared.screen_region import TOUCHED, in_screen_region, without_tiles
from .spec import (
    BEHIND,
    IMAGE,
    INVERTED_ALPHA,
    MAX,
    OVER,
    SAMPLE_FEATURES,
    SEEN_THROUGH_BOTH,
    Buffer,
    Loop,
    Method,
    Param,
    Pass,
    State,
    Target,
)

ORDER = 1

SAMPLES = Param("samples", 4, "samples of a pixel, fragments taken by a pass; 8 in the source", of=(4, 8, 16, 32),
                needs={str(count): feature for feature, count in SAMPLE_FEATURES.items()})
MIDDLE = replace(PEELED, doc="layers peeled at most, half from the front and half from the back; 0: all of them",
                 weakens={"1-4096": "of more fragments than `layers`, those in the middle are missing"})
TOUCHED_BOUNDS = without_tiles("since most full-screen passes stand between the geometry passes")
NO_BOUNDS = (-2.0, -2.0, 0.0, 0.0)  # below every (-z, z)
SEEN_THROUGH = (0.0, 0.0, 0.0, 1.0)  # no colour, with transmittance
UNBOUNDED = (1.0, 2.0, 0.0, 0.0)  # as (-z, z) around every depth

METHODS = [
    Method(
        id="peel-f2b", name="F2B", family="peel",
        source="Everitt 2001; kplus_2015 §2",
        summary="front-to-back peeling: one layer per geometry pass, until an occlusion query sees none",
        guarantee="exact all", words="6", cost="one geometry pass per layer",
        ties="one of them is kept, the others are lost", loses_ties=True, most_layers="layers",
        params=(PEELED, STOP_OPACITY, TOUCHED_BOUNDS),
        targets=(Target("layer", "rgba32f", doc="colour of the layer just peeled"),
                 Target("layer_depth", "depth32f", copies=2, doc="depth of this layer, and of the one before")),
        steps=in_screen_region(
            replace(CLEAR_IMAGE, clears={IMAGE: SEEN_THROUGH}),
            Loop((
                Pass("peel", "geometry", "methods/peel/f2b.frag", reads=("layer_depth.previous",),
                     into=("layer", "layer_depth.current"), clears={"layer": CLEARED, "layer_depth.current": (1.0,)},
                     state=State(depth_test="lequal"), counts=True, expand=peeling),
                Pass("peel", "fullscreen", "methods/peel/stored_layer.frag", reads=("layer", "layer_depth.current"),
                     probes=STORED),
                Pass("composite", "fullscreen", "methods/peel/copy.frag", reads=("layer",), into=(IMAGE,),
                     state=State(blend=BEHIND, blend_alpha=SEEN_THROUGH_BOTH)),
            ), times="min(n + 1, layers or n + 1)"),
            Pass("composite", "fullscreen", "methods/peel/finish.frag", into=(IMAGE,),
                 state=State(blend=("add", "zero", "one"), blend_alpha=INVERTED_ALPHA)),
        ),
    ),
    Method(
        id="peel-dual", name="DUAL", family="peel", merges=True,
        source="Bavoil & Myers 2008; kplus_2015 §2",
        summary="dual peeling: the nearest and the furthest layer per geometry pass, by MAX blending",
        guarantee="exact all", words="20", cost="one geometry pass for every two layers",
        ties="the maximum of each channel is kept", loses_ties=True, params=(MIDDLE, TOUCHED_BOUNDS),
        targets=(Target("bounds", "rg32f", copies=2, doc="(-nearest, furthest) depth of the fragments that are left"),
                 Target("ahead", "rgba32f", doc="nearest layer just peeled"),
                 Target("behind", "rgba32f", doc="furthest layer just peeled"),
                 Target("front", "rgba32f", doc="front layers composited, with transmittance"),
                 Target("back", "rgba32f", doc="back layers composited")),
        steps=in_screen_region(
            Pass("bounds", "geometry", "common/depth_bounds.frag", into=("bounds.previous",),
                 clears={"bounds.previous": NO_BOUNDS}, state=State(blend=MAX)),
            Pass("clear", "clear", into=("front", "back"), clears={"front": SEEN_THROUGH, "back": CLEARED}),
            Loop((
                Pass("peel", "geometry", "methods/peel/dual.frag", reads=("bounds.previous",),
                     into=("bounds.current", "ahead", "behind"),
                     clears={"bounds.current": NO_BOUNDS, "ahead": CLEARED, "behind": CLEARED}, state=State(blend=MAX)),
                Pass("peel", "fullscreen", "methods/peel/stored_dual.frag", reads=("bounds.previous",), probes=STORED),
                Pass("blend", "fullscreen", "methods/peel/dual_front.frag", reads=("ahead",), into=("front",),
                     state=State(blend=BEHIND, blend_alpha=SEEN_THROUGH_BOTH)),
                Pass("blend", "fullscreen", "methods/peel/dual_blend.frag", reads=("behind", "bounds.current"),
                     into=("back",), state=State(blend=OVER), counts=True),
            ), times="min(n // 2 + 1, ceil(layers / 2) or n // 2 + 1)"),
            Pass("combine", "fullscreen", "methods/peel/dual_combine.frag", reads=("front", "back"), into=(IMAGE,)),
        ),
    ),
    Method(
        id="peel-bucket", name="BUN", family="peel", merges=True,
        source="Liu et al. 2009; Vasilakis & Fudos 2013; kplus_2015 §2",
        summary="bucket peeling: the pixel's depth range in uniform buckets, the nearest and the furthest fragment of "
                "each per geometry pass, by MAX blending into as many targets",
        guarantee="exact all", words="2 + 14*buckets", ties="one of them is kept, the others are lost", loses_ties=True,
        params=(Param("buckets", 8, "buckets of a pixel, each a render target", high=8), TOUCHED_BOUNDS),
        targets=(Target("bounds", "rg32f", doc="(-nearest, furthest) depth of the pixel"),
                 Target("edges", "rg32f", copies=2, layers="buckets",
                        doc="(-nearest, furthest) depth of the fragments left in each bucket")),
        buffers=(Buffer("colours", "2*buckets*P", doc="colours of the two fragments just peeled, per bucket"),
                 Buffer("layers", "8*buckets*P", type="vec4", clear="0.0, 0.0, 0.0, 1.0",
                        doc="front and back layers composited, with transmittance, per bucket")),
        steps=in_screen_region(
            Pass("bounds", "geometry", "common/depth_bounds.frag", into=("bounds",),
                 clears={"bounds": NO_BOUNDS}, state=State(blend=MAX)),
            Pass("clear", "clear", into=("edges.previous",), clears={"edges.previous": UNBOUNDED}),
            clear("layers"),
            Loop((
                Pass("peel", "geometry", "methods/peel/bucket.frag", reads=("bounds", "edges.previous"),
                     writes=("colours",), into=("edges.current",), clears={"edges.current": NO_BOUNDS},
                     state=State(blend=MAX)),
                Pass("peel", "fullscreen", "methods/peel/stored_buckets.frag", reads=("edges.previous",),
                     probes=STORED),
                Pass("blend", "fullscreen", "methods/peel/bucket_blend.frag",
                     reads=("edges.previous", "edges.current", "colours"), writes=("layers",), counts=True),
            ), times="n // 2 + 2"),
            Pass("combine", "fullscreen", "methods/peel/bucket_combine.frag", reads=("layers",), into=(IMAGE,)),
        ),
    ),
    Method(
        id="peel-srab", name="SRAB multi-pass", family="peel",
        source="Myers & Bavoil 2007; Bavoil & Myers 2008",
        summary="stencil-routed A-buffer: each geometry pass takes the next `samples` fragments of a pixel, in order "
                "of arrival; the resolve sorts them all",
        guarantee="exact all", words="2*samples*ceil(n/samples) + samples", ties="kept, in no fixed order",
        beside="each pass copies its targets into an array: 2n words and 3 per sample in place of all passes' targets, "
               "and for each pixel where the next pass resumes and how many fragments it has",
        cost="one geometry pass for every `samples` layers",
        params=(SAMPLES, MULTISAMPLING, *RESOLVE_OPTIONS, TOUCHED),
        targets=(*routed_targets("samples"), replace(ARRIVALS, samples="samples")),
        buffers=(COLLECTED, RESUME, IN_ORDER),
        steps=in_screen_region(
            clear("counter", "resume"),
            Loop(collected("samples", "n"), times="ceil(n/samples)"),
            resolve_collected("n"),
        ),
    ),
]
