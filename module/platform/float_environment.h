// The same floating-point environment for every public call and every task.
//
// FloatingPointScope rounds to nearest, keeps denormals and raises nothing while it lives; then it puts back what was
// there, flags of past exceptions included. Engines like to flush denormals or to unmask exceptions on their threads:
// either would change our bits. Every public function that computes with floats makes one of these before anything
// else, and so does every task.
//
// FlushDenormalsScope takes denormals for zero while it lives, on top of the default environment: for kernels whose
// functions fade away towards the poles, where each denormal would cost a hundred cycles. Which results count as
// denormal differs between processors, so where it lives nothing that small may matter (transform/spectrum.cpp).
#pragma once

#if defined(__aarch64__)
#include "platform/float_environment_arm.h"
#elif defined(__wasm__)
#include "platform/float_environment_wasm.h"
#else
#include "platform/float_environment_x86.h"
#endif
