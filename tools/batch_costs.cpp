#include "tools/batch_costs.h"

#include <algorithm>

namespace welkin::tool {

double seconds_of_job(const Prediction& prediction, const BakeCommandOptions& options) {
  // Measured with bakes of photographs of 1024 x 512 with `--size 256` and more on one thread of Zen 4. They only
  // decide what is a fair share.
  constexpr double kSecondsOfAJob = 0.02;         // opening, hashing and naming eight files
  constexpr double kSecondsOfATexel = 60e-9;      // reading one, and transforming it
  constexpr double kSecondsOfAByte = 10e-9;       // of the results in memory: making it, and encoding it
  constexpr double kSecondsOfZlibByte = 40e-9;    // the same where files are compressed by zlib
  constexpr double kSecondsOfBlockByte = 160e-9;  // or have ASTC blocks
  constexpr double kSecondsOfPreviews = 0.12;     // of spheres of the default size
  double seconds_of_a_byte = kSecondsOfAByte;
  for (const OutputFile& file : options.files) {
    const bool has_blocks = file.format == TexelFormat::astc_4x4_hdr || file.format == TexelFormat::astc_6x6_hdr;
    if (has_blocks) seconds_of_a_byte = kSecondsOfBlockByte;
    if (file.supercompression == Supercompression::zlib)
      seconds_of_a_byte = std::max(seconds_of_a_byte, kSecondsOfZlibByte);
  }
  const double sphere = static_cast<double>(options.preview_size) / BakeCommandOptions().preview_size;
  return kSecondsOfAJob + kSecondsOfATexel * static_cast<double>(prediction.texels) +
         seconds_of_a_byte * static_cast<double>(prediction.result_bytes) +
         (options.previews ? kSecondsOfPreviews * sphere * sphere : 0.0);
}

}  // namespace welkin::tool
