#pragma once

#include <vector>

namespace welkin::perf {

/// SkyTables/LAYOUT/ORDERS/THREADS: precomputing an Earth of the usual sizes (compact: 32 x 64 x 32), all tables.
/// SkyTransmittance/table/64x256/1: what one order of the smallest scattering table takes, nearly all of it lengths.
void add_sky_tables(const std::vector<int>& thread_counts);

}  // namespace welkin::perf
