// An engine's arena, lent through a function pointer.
#pragma once

#include <functional>

#include "welkin/welkin.h"

namespace welkin::c_interface {

/// As `WorkerOptions` wants it; empty if `enqueue` is null.
[[nodiscard]] std::function<void(std::function<void()>)> lent_arena(decltype(welkin_worker_options::enqueue) enqueue,
                                                                    void* user);

}  // namespace welkin::c_interface
