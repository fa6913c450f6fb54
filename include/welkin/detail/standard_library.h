// What public headers need of the standard library and some libraries lack: libc++ before version 18 or so has no
// <stop_token>, and before version 16 no <memory_resource>. Where the library has them these are its own types, so that
// a host's `std::stop_token` is passed as it is; where it does not, they are the small equivalents of
// detail/stop_token.h and detail/memory_resource.h, with the same members.
#pragma once

#include <version>

#include "welkin/detail/memory_resource.h"
#include "welkin/detail/stop_token.h"

#ifdef __cpp_lib_jthread
#include <stop_token>
#endif
#ifdef __cpp_lib_memory_resource
#include <memory_resource>
#endif

namespace welkin {

#ifdef __cpp_lib_jthread
using std::nostopstate;
using std::stop_callback;
using std::stop_source;
using std::stop_token;
#else
using detail::standard::nostopstate;
using detail::standard::stop_callback;
using detail::standard::stop_source;
using detail::standard::stop_token;
#endif

#ifdef __cpp_lib_memory_resource
using std::pmr::get_default_resource;
using std::pmr::memory_resource;
using std::pmr::new_delete_resource;
#else
using detail::standard::get_default_resource;
using detail::standard::memory_resource;
using detail::standard::new_delete_resource;
#endif

}  // namespace welkin
