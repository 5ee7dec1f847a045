// IS_HELPER tells whether this is a helper invocation, which exists only for the derivatives of its neighbours. Its
// loads return no reliable values and its atomics do nothing, so a loop whose end depends on memory must not start in
// it (llvmpipe would run such a loop up to its iteration limit).
#if COMPUTE
#define IS_HELPER false
#elif defined(GL_ARB_ES3_1_compatibility)
#define IS_HELPER gl_HelperInvocation
#else
#define IS_HELPER (gl_SampleMaskIn[0] == 0)
#endif
