// Preconditions: a broken one is a bug in the caller, never bad input.
//
// On in debug builds and in CI (RILIEVO_CHECKS=ON); compiled out otherwise. Both operands of a
// comparison are printed, so that a failure in CI can be read without a debugger.
#pragma once

#ifdef RILIEVO_CHECKS
#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <string>

namespace rilievo::detail {

[[noreturn]] inline void expectation_failed(const char* what, const std::string& operands,
                                            const char* file, int line) {
  std::fprintf(stderr, "%s:%d: expects %s%s\n", file, line, what, operands.c_str());
  std::abort();
}

template <class A, class B>
std::string operands(const A& a, const B& b) {
  std::ostringstream out;
  out << " (" << a << " against " << b << ")";
  return out.str();
}

}  // namespace rilievo::detail

#define RILIEVO_EXPECTS(condition) \
  ((condition) ? void(0)           \
               : ::rilievo::detail::expectation_failed(#condition, "", __FILE__, __LINE__))
#define RILIEVO_EXPECTS_OP_(a, op, b)                  \
  (((a)op(b)) ? void(0)                                \
              : ::rilievo::detail::expectation_failed( \
                    #a " " #op " " #b, ::rilievo::detail::operands((a), (b)), __FILE__, __LINE__))
#else
#define RILIEVO_EXPECTS(condition) void(0)
#define RILIEVO_EXPECTS_OP_(a, op, b) void(0)
#endif

#define RILIEVO_EXPECTS_EQ(a, b) RILIEVO_EXPECTS_OP_(a, ==, b)
#define RILIEVO_EXPECTS_LT(a, b) RILIEVO_EXPECTS_OP_(a, <, b)
#define RILIEVO_EXPECTS_LE(a, b) RILIEVO_EXPECTS_OP_(a, <=, b)
#define RILIEVO_EXPECTS_GT(a, b) RILIEVO_EXPECTS_OP_(a, >, b)
#define RILIEVO_EXPECTS_GE(a, b) RILIEVO_EXPECTS_OP_(a, >=, b)
