// What every program of a sanitizer build starts with; ASAN_OPTIONS may say otherwise.

// Runtimes up to GCC 13 and LLVM 16 take a block of a thread's variables that happens to lie 16
// bytes into a page for one of a C library before 2.25, and read its size where none is: the leak
// check then dies, once in some hundred runs ("Tracer caught signal 11"). They learn the size of
// no other block either, so nothing is lost by not looking.
extern "C" const char* __asan_default_options() { return "intercept_tls_get_addr=0"; }
