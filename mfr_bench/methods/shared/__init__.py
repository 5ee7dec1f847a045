"""Parameters, buffers and passes that several families share. Each is declared once, over shared shader code.

    options         parameters
    clearing        clears of the image and of buffers, and how a pass expands into those that run
    reuse           counts and ranges that later frames of a scene use again
    locks           the semaphore of spin locks, and buffers of 64-bit elements
    routing         stencil routing into the samples of multisample targets
    in_framebuffer  fragments of shallow pixels, sorted in the framebuffer
    counting        passes that count fragments
    resolving       passes that turn the stored fragments of a pixel into its colour
    occupancy       the map by which fragments beyond the k-th are discarded
    screen_region   full-screen passes limited to the part of the screen that has geometry
    bands           a frame in bands that fit a memory budget
    prediction      k from the depth-complexity histogram of a frame
"""

from .clearing import CLEAR_IMAGE, CLEARED, Expand, clear, expanded, zeroed_apart
from .counting import SHADED, STORED, count, count_stored
from .locks import SEMAPHORE, buffers_of_64_bits
from .occupancy import KTH_DEPTH, NO_BOUNDS, OCCUPIED, UNOCCUPIED, culled, occupancy_map, occupied
from .options import (
    ACCUMULATE,
    ATOMIC64,
    BMA,
    BOUND,
    CULLING,
    CULLING_OPACITY,
    EARLY_CULLING,
    LOCAL_ARRAY,
    LOCK,
    MULTISAMPLING,
    OCCUPANCY,
    OCCUPANCY_BOUNDS,
    PAYLOAD,
    PEELED,
    RESOLVE_OPTIONS,
    REUSE_COUNT,
    SORT,
    STAGE,
    STOP_OPACITY,
    SYNC,
    TIES_OF_INSERTION,
    K,
)
from .resolving import (
    CLASS_BOUNDS,
    LPLUS,
    NARROWEST,
    PIXEL_CLASS,
    RESOLVER,
    RESOLVERS,
    TILE,
    WIDEST,
    peeling,
    resolve,
    resolve_sorted,
)
from .reuse import again, once
from .routing import ARRIVALS, COLLECTED, IN_ORDER, RESUME, collected, resolve_collected, route, routed_targets

__all__ = [
    "ACCUMULATE",
    "ARRIVALS",
    "ATOMIC64",
    "BMA",
    "BOUND",
    "CLASS_BOUNDS",
    "CLEARED",
    "CLEAR_IMAGE",
    "COLLECTED",
    "CULLING",
    "CULLING_OPACITY",
    "EARLY_CULLING",
    "IN_ORDER",
    "KTH_DEPTH",
    "LOCAL_ARRAY",
    "LOCK",
    "LPLUS",
    "MULTISAMPLING",
    "NARROWEST",
    "NO_BOUNDS",
    "OCCUPANCY",
    "OCCUPANCY_BOUNDS",
    "OCCUPIED",
    "PAYLOAD",
    "PEELED",
    "PIXEL_CLASS",
    "RESOLVER",
    "RESOLVERS",
    "RESOLVE_OPTIONS",
    "RESUME",
    "REUSE_COUNT",
    "SEMAPHORE",
    "SHADED",
    "SORT",
    "STAGE",
    "STOP_OPACITY",
    "STORED",
    "SYNC",
    "TIES_OF_INSERTION",
    "TILE",
    "UNOCCUPIED",
    "WIDEST",
    "Expand",
    "K",
    "again",
    "buffers_of_64_bits",
    "clear",
    "collected",
    "count",
    "count_stored",
    "culled",
    "expanded",
    "occupancy_map",
    "occupied",
    "once",
    "peeling",
    "resolve",
    "resolve_collected",
    "resolve_sorted",
    "route",
    "routed_targets",
    "zeroed_apart",
]
