// When OpenEXR's own static objects are made. Included by one source of the readers and one of the writers: whichever
// of them a program links brings this along.
#pragma once

#include <IlmThreadPool.h>
#include <ImfHeader.h>

#include "platform/compiler.h"

namespace welkin::files {

/// OpenEXR makes its attribute types and its pool of threads (that has none) when they are first used. They would be
/// destroyed before a worker that is a global object, whose threads may still read or write files. So they are made
/// before every static object of the program, and destroyed after it.
WELKIN_RUN_BEFORE_STATIC_OBJECTS static void make_openexr_statics() {
  Imf::staticInitialize();
  (void)IlmThread::ThreadPool::globalThreadPool();
}

}  // namespace welkin::files
