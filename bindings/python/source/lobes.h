// Lobes of the caller's choice as objects of Python's.
#pragma once

#include <pybind11/pybind11.h>

#include <string>

#include "welkin/reflections.h"

namespace welkin::python {

/// A lobe, and what it is in words.
struct NamedLobe {
  ZonalLobe lobe;
  std::string words;
};

}  // namespace welkin::python
