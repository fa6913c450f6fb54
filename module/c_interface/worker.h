// A worker as C callers hold it.
#pragma once

#include <utility>

#include "welkin/welkin.h"
#include "welkin/worker.h"

struct welkin_worker {
  explicit welkin_worker(welkin::WorkerOptions options) : worker(std::move(options)) {}

  welkin::Worker worker;
};
