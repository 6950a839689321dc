// The result of an operation on the outside world (files, OpenGL): a value, or an error that says
// where it failed and why.
//
//   Result<Scene> scene = load_scene(path);
//   if (!scene) return scene.error();
//   use(*scene);
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "rilievo/core/expects.h"

namespace rilievo {

// Where an operation failed, and why.
struct Error {
  std::string where;   // a file's path, or the device or step that failed
  std::string reason;  // one clause without a full stop: "vertex 12 of mesh 3 is not finite"

  // "where: reason", as the command line prints it.
  [[nodiscard]] std::string message() const {
    return where.empty() ? reason : where + ": " + reason;
  }
};

// The value of an operation that either succeeds without a result or fails.
struct Done {};

// A value of type T or an Error. Result<> is success or an Error.
template <class T = Done>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}
  Result(Error error) : state_(std::in_place_index<1>, std::move(error)) {}

  [[nodiscard]] bool ok() const noexcept { return state_.index() == 0; }
  explicit operator bool() const noexcept { return ok(); }

  // The value. Requires ok().
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(value()); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }
  T& value() & {
    RILIEVO_EXPECTS(ok());
    return *std::get_if<0>(&state_);
  }
  const T& value() const& {
    RILIEVO_EXPECTS(ok());
    return *std::get_if<0>(&state_);
  }
  T&& value() && { return std::move(value()); }

  // The error. Requires !ok().
  [[nodiscard]] const Error& error() const {
    RILIEVO_EXPECTS(!ok());
    return *std::get_if<1>(&state_);
  }

 private:
  std::variant<T, Error> state_;
};

}  // namespace rilievo
