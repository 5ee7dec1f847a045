// Whether this invocation exists only for its neighbours' derivatives. Its loads give nothing and its atomics
// are lost, so a loop that ends on what memory holds must not begin there (llvmpipe runs it to its limit).
#if COMPUTE
#define IS_HELPER false
#elif defined(GL_ARB_ES3_1_compatibility)
#define IS_HELPER gl_HelperInvocation
#else
#define IS_HELPER (gl_SampleMaskIn[0] == 0)
#endif
