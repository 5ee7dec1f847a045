"""A small catalog, so that these tests say what configs do and not what methods there are."""

from mfr_bench.methods.spec import ON_OFF, Buffer, Method, Param, Pass, Target

K = Param("k", 8, "fragments kept", low=1, high=1024)
CULLING = Param("culling", "on", "early test", choices=ON_OFF)
SYNC = Param("sync", "spin", "lock", choices=("spin", "interlock"), needs={"interlock": "fragment_shader_interlock"})
LOAD = Param("load_factor", 0.5, "share of the table in use", low=0, high=1, real=True)


def fake(method_id, name, *params, guarantee="exact all", buffers=(), **more):
    return Method(id=method_id, name=name, family="fake", source="none", summary="none", guarantee=guarantee,
                  words="1", steps=(Pass("store", "geometry", "none.frag"),), ties="kept", params=params,
                  buffers=buffers, **more)


CATALOG = {m.id: m for m in (
    fake("floor", "Floor", guarantee="none"),
    fake("ab-array", "AB_Array", buffers=(Buffer("nodes", "2*n*P"),)),
    fake("open-post", "POST-OPEN", LOAD, targets=(Target("head", "r32f"),)),
    fake("kb-small", "KB", Param("k", 8, "fragments kept", low=1, high=16)),
    fake("kplus-array", "K+B-Array", K, CULLING, SYNC, guarantee="exact k nearest",
         buffers=(Buffer("nodes", "2*k*P"), Buffer("counter", "P"))),
    fake("kplus-heap", "K+B-Heap", K, CULLING, SYNC, guarantee="exact k nearest", buffers=(Buffer("nodes", "2*k*P"),)),
)}
