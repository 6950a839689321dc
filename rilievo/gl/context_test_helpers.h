// For tests that need OpenGL.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <utility>

#include "rilievo/gl/context.h"

namespace rilievo::gl {

// A context is current during the test, and outlives what derived fixtures keep in it.
class ContextTest : public testing::Test {
 protected:
  void SetUp() override {
    auto context = Context::create();
    ASSERT_TRUE(context.ok()) << context.error().message();
    context_ = std::move(*context);
  }

 private:
  std::unique_ptr<Context> context_;
};

}  // namespace rilievo::gl
