// The light of a frame: a streamed environment or a dynamic sky.
#pragma once

#include <welkin/engines.h>
#include <welkin/environment_file.h>
#include <welkin/requests.h>
#include <welkin/sky_light.h>

#include <glm/mat3x3.hpp>
#include <map>
#include <stdexcept>
#include <string>

#include "upload.h"

namespace window {

constexpr int kWidth = 640, kHeight = 320;
constexpr float kHalfWidth = 0.6F, kHalfHeight = 0.3F;  // of the view at distance 1

/// The light that a frame is drawn with.
struct Frame {
  struct LitBy {
    GLuint texture = 0;
    glm::dmat3 turn{1.0};
    double weight = 0.0;
  };
  double yaw = 0.0, elevation = 40.0;  // set by the user: radians, degrees
  std::array<LitBy, 2> chains{};
  int mips = 1;
  welkin::SphericalHarmonics radiance{3};
  welkin::Sun sun{};

  [[nodiscard]] glm::dmat3 camera() const {
    return {{std::cos(yaw), 0.0, std::sin(yaw)}, {0.0, 1.0, 0.0}, {-std::sin(yaw), 0.0, std::cos(yaw)}};
  }
  [[nodiscard]] double exposure() const { return 1.5 * welkin::exposure_of(radiance); }
};

/// The worker's result for a file: filled staging memory, and harmonics.
struct Environment {
  std::vector<std::byte> staging;
  Chain chain;
  welkin::SphericalHarmonics radiance{3};
};

/// Reads and bakes a file, on the worker's threads. They convert texels to half floats, too.
inline std::shared_ptr<Environment> load(const std::string& path, const welkin::Control& control) {
  constexpr int kSize = 256;
  const welkin::BakeOptions options{
      .background = {}, .specular = welkin::PrefilterOptions{.size = kSize}, .irradiance = {}, .brdf = {}};
  const welkin::UploadLayout layout{.size = kSize, .levels = welkin::default_mip_count(*options.specular)};
  auto made = std::make_shared<Environment>();
  made->staging.resize(welkin::upload_bytes(layout));
  const std::vector<welkin::CubemapTarget> mips = welkin::upload_targets(layout, made->staging);
  const welkin::Environment file = welkin::read_environment(path, {}, control);
  made->radiance = *welkin::bake_to({.specular = mips}, file.view(), options, control).radiance;
  made->chain = {nullptr, kSize, GL_RGBA, GL_HALF_FLOAT, 8, {}};
  for (const auto& mip : mips) std::copy(mip.faces.begin(), mip.faces.end(), made->chain.mips.emplace_back().begin());
  return made;
}

/// Returns a sky's chain where it lies.
inline Chain chain_of(const std::shared_ptr<const welkin::PrefilteredSpecular>& sky) {
  Chain chain{sky, sky->cubemap.size(), GL_RGB, GL_FLOAT, 12, {}};
  for (int mip = 0; mip < sky->cubemap.levels(); ++mip) {
    auto& faces = chain.mips.emplace_back();
    for (std::size_t face = 0; face < 6; ++face) faces[face] = sky->cubemap.face(mip, static_cast<int>(face));
  }
  return chain;
}

/// For the recorder.
struct State {
  bool baking = false, uploading = false, shown = false, is_sky = false, sky_settled = false;
};

class Light {
 public:
  explicit Light(std::vector<std::string> files) : files_(std::move(files)) { next(); }

  /// Posts the next file. It replaces one that is not done, and is shown once it is uploaded.
  void next() {
    const auto request = [path = files_[next_++ % files_.size()]](const welkin::Control& control) {
      return load(path, control);
    };
    job_ = worker_.post(request, {.key = "environment"});
    is_sky_ = false;
  }

  void show_sky() { is_sky_ = true; }

  /// Once per frame: collects what is ready, uploads one slice, and sets the frame's light.
  void update(Frame& frame, double seconds) {
    constexpr std::size_t kSlice = 256 << 10;  // bytes: a chain of 256 takes 17 frames
    if (auto made = job_.try_take()) {
      arrived_ = std::move(*made);
      Chain chain = arrived_->chain;
      chain.owner = arrived_;
      upload_ = std::make_unique<Upload>(std::move(chain));
    } else if (const auto error = job_.error()) {
      throw std::runtime_error(error->message);
    }
    if (upload_ && upload_->step(kSlice)) {  // complete: texture and harmonics change in the same frame
      shown_ = std::move(upload_);
      radiance_ = arrived_->radiance;
    }
    sky_.set_sun(frame.elevation, 150.0);
    const welkin::SkyLightFrame& sky = sky_.update(seconds);
    std::erase_if(skies_, [&](const auto& old) {
      return old.first != sky.reflections[0].specular.get() && old.first != sky.reflections[1].specular.get();
    });
    if (is_sky_ && sky.ready) {
      frame.radiance = sky.radiance;
      frame.sun = sky.sun;
      for (std::size_t k = 0; k < 2; ++k) {
        const auto& [specular, turn, weight] = sky.reflections[k];
        if (!specular) continue;
        auto& upload = skies_[specular.get()];
        if (!upload) upload = std::make_unique<Upload>(chain_of(specular));
        upload->step(kSlice);  // a chain of 32 is less
        frame.chains[k] = {upload->texture(), turn, weight};
        frame.mips = upload->mips();
      }
    } else if (shown_) {
      frame.radiance = radiance_;
      frame.sun = {};
      frame.chains = {Frame::LitBy{shown_->texture(), glm::dmat3(1.0), 1.0}, Frame::LitBy{shown_->texture()}};
      frame.mips = shown_->mips();
    }
  }

  [[nodiscard]] State state() const {
    return {worker_.load().jobs > 0, upload_ != nullptr, shown_ != nullptr, is_sky_, sky_.light().settled};
  }

 private:
  std::vector<std::string> files_;
  std::size_t next_ = 0;
  welkin::Worker worker_;
  // Small tables, computed in a second or two when the window opens.
  welkin::SkyLight sky_{worker_, welkin::earth(), {.tables = {.heights = 8, .view_zeniths = 64, .sun_zeniths = 16}}};
  welkin::Job<std::shared_ptr<Environment>> job_;
  std::shared_ptr<Environment> arrived_;
  std::unique_ptr<Upload> upload_, shown_;
  std::map<const void*, std::unique_ptr<Upload>> skies_;
  welkin::SphericalHarmonics radiance_{3};
  bool is_sky_ = false;
};

}  // namespace window
