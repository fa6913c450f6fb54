// The text of probe_sampling.glsl.
#pragma once

namespace welkin::probes {

extern const char* const kProbeSampling;

}  // namespace welkin::probes
