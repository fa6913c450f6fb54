#pragma once

namespace welkin::perf {

/// TexelWeights and LatLongWeights, cold (built) and warm (from the cache).
void add_tables();

}  // namespace welkin::perf
