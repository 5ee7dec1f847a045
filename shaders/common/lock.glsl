// Mutual exclusion per pixel for the code between CRITICAL_BEGIN and CRITICAL_END (kplus_2015 §3.1, Alg. 1). `wanted`
// tells whether this fragment enters the critical section. All storage that is used inside must be coherent. Both
// macros must be placed in main, outside branches, because the interlock is allowed nowhere else.
// Buffers: updates semaphore.
#include "common/helper.glsl"

#if SYNC_SPIN

// The lock is released inside the iteration that acquired it, because the lanes of a warp wait for each other. The
// barrier after acquiring it prevents reads from moving before it; the barrier before releasing it publishes writes.
// A plain store releases: as long as the lock is held, others change the semaphore from 1 to 1 alone, so that none of
// them can undo the store, however late it arrives.
#define CRITICAL_BEGIN(p, wanted) \
    bool waiting = (wanted) && !IS_HELPER; \
    COUNT(refused, !waiting && !IS_HELPER) \
    COUNT(entered, waiting) \
    for (uint tries = 0u; waiting && tries < uint(LOCK_TRIES); ++tries) { \
        if (atomicExchange(semaphore[p], 1u) == 0u) { \
            memoryBarrierBuffer();
#define CRITICAL_END(p) \
            memoryBarrierBuffer(); \
            semaphore[p] = 0u; \
            waiting = false; \
            COUNT(spins, tries) \
            COUNT_MOST(longest_wait, tries) \
        } \
    } \
    if (waiting) atomicAdd(lost_fragments, 1u);

#elif SYNC_NONE

#define CRITICAL_BEGIN(p, wanted) if ((wanted) && !IS_HELPER) {
#define CRITICAL_END(p) }

#else

#if SYNC_ORDERED
#define INTERLOCKED pixel_interlock_ordered
#else
#define INTERLOCKED pixel_interlock_unordered
#endif

#if defined(GL_ARB_fragment_shader_interlock)
layout(INTERLOCKED) in;
#define INTERLOCK_BEGIN beginInvocationInterlockARB()
#define INTERLOCK_END endInvocationInterlockARB()
#elif defined(GL_NV_fragment_shader_interlock)
layout(INTERLOCKED) in;
#define INTERLOCK_BEGIN beginInvocationInterlockNV()
#define INTERLOCK_END endInvocationInterlockNV()
#elif defined(GL_INTEL_fragment_shader_ordering)
#define INTERLOCK_BEGIN beginFragmentShaderOrderingINTEL()
#define INTERLOCK_END
#else
#error sync: interlock and sync: ordered need a fragment shader interlock extension
#endif

// The interlock orders accesses; the barrier makes them visible to the next invocation.
#define CRITICAL_BEGIN(p, wanted) \
    COUNT(refused, !(wanted)) \
    COUNT(entered, wanted) \
    INTERLOCK_BEGIN; \
    if (wanted) {
#define CRITICAL_END(p) \
        memoryBarrierBuffer(); \
    } \
    INTERLOCK_END;

#endif
