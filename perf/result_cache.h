#pragma once

namespace welkin::perf {

/// What is saved when results are found again, on 2 threads: the tables of docs/cache.md.
/// - Cache/bake-...: a bake of a 1024 x 512 lat-long with a specular cubemap of 256, all else default: computed without
///   a cache; the first time, stored in memory or in a folder too; found in memory, on disk; with another last mip.
/// - Cache/hash: the lat-long's hash alone.
/// - Cache/cubemap-...: three bands of a cubemap of 1024: hashed, projected, one face of it, and the sum of all faces.
void add_result_cache();

}  // namespace welkin::perf
