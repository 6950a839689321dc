// Checks of preconditions. A broken one is a bug in the caller, never bad input.
//
// Checks run in debug builds and in CI (RILIEVO_CHECKS=ON) and compile to nothing otherwise. A
// failed comparison prints both operands, so that a log suffices to understand it.
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

// Aborts with file, line and text unless `condition` holds.
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

// Aborts unless a == b; prints both operands.
#define RILIEVO_EXPECTS_EQ(a, b) RILIEVO_EXPECTS_OP_(a, ==, b)
// Aborts unless a < b; prints both operands.
#define RILIEVO_EXPECTS_LT(a, b) RILIEVO_EXPECTS_OP_(a, <, b)
// Aborts unless a <= b; prints both operands.
#define RILIEVO_EXPECTS_LE(a, b) RILIEVO_EXPECTS_OP_(a, <=, b)
// Aborts unless a > b; prints both operands.
#define RILIEVO_EXPECTS_GT(a, b) RILIEVO_EXPECTS_OP_(a, >, b)
// Aborts unless a >= b; prints both operands.
#define RILIEVO_EXPECTS_GE(a, b) RILIEVO_EXPECTS_OP_(a, >=, b)
