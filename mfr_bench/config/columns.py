"""The names that a figure may draw: columns of results.csv, what follows from them, and for stacked bars passes.csv."""

from .model import KEPT

IDENTITY = ("experiment", "method", "label", "status", "width", "height", "pixel_density", "depth_complexity", "k",
            "fragment_probability", "order", "seed")
MEASURED = ("fragments", "covered_pixels", "max_fragments", "samples", "time_ms", "time_ms_low", "time_ms_high",
            "floor_ms", "memory_bytes", "memory_model_bytes", "max_abs_error", "error_bound", "rmse", "psnr_db", "flip",
            "hit_ratio", "promised_ratio", "distinct_images",
            "wrong_pixels", "tied_pixels", "max_error_all", "wrong_pixels_all", "lost_fragments", "discarded_share",
            "culled_share", "luminance_error", "hue_error", "geometry_passes",
            # derived when a figure is drawn: report.data.MEASURES
            "fps", "floor_ratio", "memory_mib", "memory_model_mib", "ms_per_mib", "ms_times_mib", "fps_per_mib",
            "words_per_pixel", "culled_of_unkept")
PER_PASS = ("time_ms", "share")
ERRORS = ("rmse", "flip", "max_error_all", "wrong_pixels_all")  # against all fragments
COSTS = ("time_ms", "memory_bytes", "memory_mib")
# y of a kind of figure, where it is not any of MEASURED; x, where it is not anything.
MEASURED_BY_KIND = {"stacked_passes": PER_PASS, "maps": KEPT, "histogram": ("time_ms",), "pareto": ERRORS,
                    "heat": (*MEASURED, "best_ratio"), "work": ("time_ms",)}
ALONG_BY_KIND = {"pareto": COSTS}
