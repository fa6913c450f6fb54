// The window without a user: a script of events, the times of its frames, and pixels for a test to judge.
#pragma once

#include <SDL.h>

#include <chrono>
#include <cstdio>
#include <fstream>
#include <glm/geometric.hpp>
#include <iomanip>
#include <limits>

#include "light.h"

namespace window {

class Recorder {
 public:
  explicit Recorder(const std::vector<std::string>& words) {
    for (std::size_t k = 0; k < words.size(); ++k) {
      const auto value = [&] {
        return k + 1 < words.size() ? words[++k] : throw std::runtime_error("a value is missing");
      };
      if (words[k] == "--frames") {
        frames_ = std::stoi(value());
      } else if (words[k] == "--record") {
        record_ = value();
      } else if (words[k] == "--screenshot") {
        screenshot_ = value();
      } else {
        files_.push_back(words[k]);
      }
    }
  }

  [[nodiscard]] const std::vector<std::string>& files() const noexcept { return files_; }

  void begin_frame() { begun_ = std::chrono::steady_clock::now(); }

  /// Ends the measured part of a frame, and pushes what the user does next: a third of the frames nothing but turning,
  /// a third new environments, each as soon as the one before is shown, a third a sinking sun.
  void end_frame(const Frame& frame, const State& state) {
    if (frames_ == 0) return;
    glFinish();
    const double milliseconds =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begun_).count();
    const bool quiet = !state.baking && !state.uploading;
    if (frame_ < 0) {  // waits for the first environment and for the sky's tables
      if (quiet && state.shown && state.sky_settled) frame_ = 0;
      return;
    }
    if (frame_ >= frames_) {  // the last image: what was asked for last is shown
      if (!quiet || !state.sky_settled) return;
      judge("sky", frame);
      return push_key(SDLK_ESCAPE);
    }
    if (frame_ >= 2 * frames_ / 3 && !state.is_sky) {
      if (!quiet) return;
      judge("environment", frame);
      return push_key(SDLK_s);
    }
    times_[state.is_sky ? 3 : state.baking ? 1 : state.uploading ? 2 : 0].push_back(milliseconds);
    push_key(SDLK_RIGHT);
    if (frame_ >= frames_ / 3 && !state.is_sky && quiet) push_key(SDLK_n);
    if (state.is_sky) push_drag(frame_ - 2 * frames_ / 3);
    ++frame_;
  }

  /// Prints the times, and writes the record.
  int finish() {
    if (frames_ == 0) return 0;
    std::ofstream file(record_);
    file << std::setprecision(9) << "{";
    constexpr std::array kNames{"idle", "baking", "uploading", "sky"};
    for (std::size_t k = 0; k < kNames.size(); ++k) {
      std::vector<double>& times = times_[k];
      std::sort(times.begin(), times.end());
      const auto at = [&](double share) {
        return times.empty() ? 0.0 : times[static_cast<std::size_t>(share * static_cast<double>(times.size() - 1))];
      };
      std::printf("%-10s%5zu frames, p50 %6.2f ms, p99 %6.2f ms, longest %6.2f ms\n", kNames[k], times.size(), at(0.5),
                  at(0.99), at(1.0));
      file << "\"" << kNames[k] << "\": {\"frames\": " << times.size() << ", \"p50\": " << at(0.5)
           << ", \"p99\": " << at(0.99) << ", \"longest\": " << at(1.0) << "},\n";
    }
    file << "\"pixels\": [\n" << pixels_ << "]}\n";
    return file.good() ? 0 : 1;
  }

 private:
  static void push_key(SDL_Keycode key) {
    SDL_Event event{};
    event.type = SDL_KEYDOWN;
    event.key.keysym.sym = key;
    SDL_PushEvent(&event);
  }

  void push_drag(int step) {
    SDL_Event event{};
    event.type = SDL_MOUSEMOTION;
    event.motion.state = SDL_BUTTON_LMASK;
    event.motion.y = kHeight / 3 + step * kHeight / (2 * frames_);  // from 60 degrees downwards
    SDL_PushEvent(&event);
  }

  /// Notes pixels of the white sphere and of the mirror, with their normals in the world and what the white sphere's
  /// must be by the library; and writes the image.
  void judge(const std::string& what, const Frame& frame) {
    std::vector<std::uint8_t> image(3 * kWidth * kHeight);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, kWidth, kHeight, GL_RGB, GL_UNSIGNED_BYTE, image.data());
    const welkin::SphericalHarmonics irradiance = welkin::irradiance_from_radiance(frame.radiance);
    std::ostringstream text;
    text << std::setprecision(9);
    for (const auto& [sphere, centre] :
         {std::pair("white", glm::dvec3(5.5, -1.1, 0.0)), std::pair("mirror", glm::dvec3(-5.5, 1.1, 0.0))}) {
      for (const auto& [x, y] : {std::pair(0.0, 0.0), {0.7, 0.0}, {-0.7, 0.0}, {0.0, 0.7}, {0.0, -0.7}}) {
        // The pixel in which about this point is seen; then the point that this pixel sees.
        const glm::dvec3 near = centre + glm::dvec3(x, y, 0.7);
        const int column = static_cast<int>((near.x / (12.0 - near.z) / kHalfWidth + 1.0) * 0.5 * kWidth);
        const int row = static_cast<int>((near.y / (12.0 - near.z) / kHalfHeight + 1.0) * 0.5 * kHeight);
        const glm::dvec3 eye(0.0, 0.0, 12.0);
        const glm::dvec3 ray = glm::normalize(glm::dvec3(((column + 0.5) / kWidth * 2.0 - 1.0) * kHalfWidth,
                                                         ((row + 0.5) / kHeight * 2.0 - 1.0) * kHalfHeight, -1.0));
        const double along = glm::dot(centre - eye, ray);
        const double past = glm::length(centre - eye - along * ray);
        const glm::dvec3 n = frame.camera() * (eye + (along - std::sqrt(1.0 - past * past)) * ray - centre);
        const glm::dvec3 r = glm::reflect(frame.camera() * ray, n);
        const glm::dvec3 white =
            frame.exposure() / 3.14159265358979 *
            (welkin::evaluate(irradiance, n) + frame.sun.irradiance * std::max(0.0, glm::dot(n, frame.sun.direction)));
        const std::uint8_t* rgb = &image[static_cast<std::size_t>(3 * (row * kWidth + column))];
        text << (pixels_.empty() && text.str().empty() ? "" : ",\n") << "{\"light\": \"" << what << "\", \"sphere\": \""
             << sphere << "\", \"exposure\": " << frame.exposure() << ", \"rgb\": [" << int{rgb[0]} << ", "
             << int{rgb[1]} << ", " << int{rgb[2]} << "], \"normal\": [" << n.x << ", " << n.y << ", " << n.z
             << "], \"reflected\": [" << r.x << ", " << r.y << ", " << r.z << "], \"white\": [" << white.x << ", "
             << white.y << ", " << white.z << "]}";
      }
    }
    pixels_ += text.str();
    if (screenshot_.empty()) return;
    // Twice as wide as high: for the library an image like any other. It converts linear floats to sRGB.
    const std::ptrdiff_t row_bytes = 3 * kWidth;
    const welkin::LatLongView view{&image[static_cast<std::size_t>(row_bytes * (kHeight - 1))], kWidth, kHeight,
                                   -row_bytes, welkin::PixelFormat::srgb8};
    welkin::write_environment(screenshot_ + "_" + what + ".png", view);
  }

  std::vector<std::string> files_;
  std::string record_ = "frames.json", screenshot_, pixels_;
  int frames_ = 0, frame_ = -1;
  std::chrono::steady_clock::time_point begun_;
  std::array<std::vector<double>, 4> times_;
};

}  // namespace window
