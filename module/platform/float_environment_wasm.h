// The floating-point environment of WebAssembly, which has but one: it always rounds to nearest, keeps denormals and
// raises nothing. What float_environment.h declares.
#pragma once

namespace welkin::platform {

class FloatingPointScope {
 public:
  FloatingPointScope() noexcept {}  // NOLINT(modernize-use-equals-default): an object that is not unused
};

/// Denormals stay: nothing may depend on them where this lives.
class FlushDenormalsScope {
 public:
  FlushDenormalsScope() noexcept {}  // NOLINT(modernize-use-equals-default): likewise
};

}  // namespace welkin::platform
