#include "tools/batch_costs.h"

namespace welkin::tool {

double seconds_of_job(const Prediction& prediction, const BakeCommandOptions& options) {
  // Of bakes of photographs of 1024 x 512 with `--size 256` and more on one thread of Zen 4. They only decide what is a
  // fair share.
  constexpr double kSecondsOfAJob = 0.02;         // opening, hashing and naming eight files
  constexpr double kSecondsOfATexel = 60e-9;      // reading one, and transforming it
  constexpr double kSecondsOfAByte = 10e-9;       // of the results in memory: making it, and encoding it
  constexpr double kSecondsOfBlockByte = 160e-9;  // the same where files have ASTC blocks
  constexpr double kSecondsOfPreviews = 0.12;     // of spheres of the default size
  double seconds_of_a_byte = kSecondsOfAByte;
  for (const OutputFile& file : options.files) {
    if (file.format == TexelFormat::astc_4x4_hdr || file.format == TexelFormat::astc_6x6_hdr)
      seconds_of_a_byte = kSecondsOfBlockByte;
  }
  const double sphere = static_cast<double>(options.preview_size) / BakeCommandOptions().preview_size;
  return kSecondsOfAJob + kSecondsOfATexel * static_cast<double>(prediction.texels) +
         seconds_of_a_byte * static_cast<double>(prediction.result_bytes) +
         (options.previews ? kSecondsOfPreviews * sphere * sphere : 0.0);
}

}  // namespace welkin::tool
