// A window whose light is streamed: a worker bakes environments while frames are drawn, the window uploads them in
// slices and shows them when they are complete. Or a sky whose sun follows a slider.
//
//   window FILE...      n: next environment; s: sky; left, right: turn; up, down, or the mouse with its button: the sun
//   window --frames N --record OUT.json --screenshot OUT FILE...    by the script of record.h, without a user
#include <SDL.h>
#include <epoxy/gl.h>

#include <cstring>
#include <stdexcept>

#include "light.h"
#include "record.h"
#include "shaders.h"

namespace window {
namespace {

GLuint make_program() {
  const GLuint program = glCreateProgram();
  for (const auto& [kind, text] :
       {std::pair(GL_VERTEX_SHADER, window::kVertexShader), std::pair(GL_FRAGMENT_SHADER, window::kFragmentShader)}) {
    const GLuint shader = glCreateShader(static_cast<GLenum>(kind));
    glShaderSource(shader, 1, &text, nullptr);
    glCompileShader(shader);
    glAttachShader(program, shader);
  }
  glLinkProgram(program);
  GLint good = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &good);
  if (good == 0) throw std::runtime_error("the shaders do not compile");
  return program;
}

void make_brdf_texture() {  // in unit 2, for good
  const auto table = welkin::brdf_table({.sheen = false});
  GLuint texture = 0;
  glGenTextures(1, &texture);
  glActiveTexture(GL_TEXTURE2);
  glBindTexture(GL_TEXTURE_2D, texture);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RG16F, table->options.width, table->options.height, 0, GL_RG, GL_FLOAT,
               table->values.data());
  for (const GLenum name : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    glTexParameteri(GL_TEXTURE_2D, name, GL_LINEAR);
  for (const GLenum name : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T}) {
    glTexParameteri(GL_TEXTURE_2D, name, GL_CLAMP_TO_EDGE);
  }
}

/// Sets the uniforms of a frame and draws it.
void draw(GLuint program, const Frame& frame) {
  const auto at = [&](const char* name) { return glGetUniformLocation(program, name); };
  for (int k = 0; k < 2; ++k) {
    const auto& [texture, turn, weight] = frame.chains[static_cast<std::size_t>(k)];
    glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(k));
    glBindTexture(GL_TEXTURE_CUBE_MAP, texture);
    const glm::mat3 rotation(turn);
    glUniformMatrix3fv(at("turn") + k, 1, GL_FALSE, &rotation[0][0]);
    glUniform1f(at("weight") + k, static_cast<float>(weight));
    glUniform1i(at("chain") + k, k);
  }
  glUniform1i(at("brdf"), 2);
  const welkin::EngineLight light = welkin::engine_light(frame.radiance, welkin::Engine::welkin);
  for (int k = 0; k < 9; ++k) {
    const glm::vec3 rgb(light.terms[static_cast<std::size_t>(k)].rgb);
    glUniform3fv(at("sh") + k, 1, &rgb[0]);
  }
  const glm::vec3 sun(frame.sun.direction), irradiance(frame.sun.irradiance);
  const glm::mat3 camera(frame.camera());
  glUniform3fv(at("sun"), 1, &sun[0]);
  glUniform3fv(at("sun_irradiance"), 1, &irradiance[0]);
  glUniformMatrix3fv(at("camera"), 1, GL_FALSE, &camera[0][0]);
  glUniform2f(at("frustum"), kHalfWidth, kHalfHeight);
  glUniform1f(at("mips"), static_cast<float>(frame.mips));
  glUniform1f(at("exposure"), static_cast<float>(frame.exposure()));
  glUniform1f(at("slider"), static_cast<float>(frame.elevation / 45.0 - 1.0));
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

/// Handles what the user did since the last frame. Returns false at the end.
bool handle_events(Light& light, Frame& frame) {
  for (SDL_Event event; SDL_PollEvent(&event) != 0;) {
    if (event.type == SDL_QUIT) return false;
    if (event.type == SDL_MOUSEMOTION && (event.motion.state & SDL_BUTTON_LMASK) != 0) {
      frame.elevation = 90.0 * (1.0 - event.motion.y / double{kHeight});
    }
    if (event.type != SDL_KEYDOWN) continue;
    switch (event.key.keysym.sym) {
      case SDLK_ESCAPE: return false;
      case SDLK_n: light.next(); break;
      case SDLK_s: light.show_sky(); break;
      case SDLK_LEFT: frame.yaw -= 0.05; break;
      case SDLK_RIGHT: frame.yaw += 0.05; break;
      case SDLK_UP: frame.elevation = std::min(90.0, frame.elevation + 0.5); break;
      case SDLK_DOWN: frame.elevation = std::max(0.0, frame.elevation - 0.5); break;
      default: break;
    }
  }
  return true;
}

int run(const std::vector<std::string>& words) {
  Recorder recorder(words);  // without its options, the window is the user's
  if (recorder.files().empty()) throw std::runtime_error("no files");
  if (SDL_Init(SDL_INIT_VIDEO) != 0) throw std::runtime_error(SDL_GetError());
  SDL_GL_SetAttribute(SDL_GL_CONTEXT_PROFILE_MASK, SDL_GL_CONTEXT_PROFILE_CORE);
  SDL_GL_SetAttribute(SDL_GL_CONTEXT_MAJOR_VERSION, 3);
  SDL_GL_SetAttribute(SDL_GL_CONTEXT_MINOR_VERSION, 3);
  SDL_Window* window = SDL_CreateWindow("Welkin", 0, 0, kWidth, kHeight, SDL_WINDOW_OPENGL);
  const SDL_GLContext context = window != nullptr ? SDL_GL_CreateContext(window) : nullptr;
  if (context == nullptr) throw std::runtime_error(SDL_GetError());
  SDL_GL_SetSwapInterval(1);
  glUseProgram(make_program());
  GLuint vertices = 0;  // none, but a core profile wants an array
  glGenVertexArrays(1, &vertices);
  glBindVertexArray(vertices);
  glEnable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
  make_brdf_texture();
  GLint program = 0;
  glGetIntegerv(GL_CURRENT_PROGRAM, &program);
  {
    Light light(recorder.files());
    Frame frame;
    for (Uint64 last = SDL_GetTicks64(); handle_events(light, frame);) {
      recorder.begin_frame();
      const Uint64 now = SDL_GetTicks64();
      light.update(frame, static_cast<double>(now - std::exchange(last, now)) / 1000.0);
      draw(static_cast<GLuint>(program), frame);
      recorder.end_frame(frame, light.state());
      SDL_GL_SwapWindow(window);
      if (const Uint64 spent = SDL_GetTicks64() - now; spent < 16) SDL_Delay(static_cast<Uint32>(16 - spent));
    }
  }
  SDL_GL_DeleteContext(context);
  SDL_DestroyWindow(window);
  SDL_Quit();
  return recorder.finish();
}

}  // namespace
}  // namespace window

int main(int count, char** words) {
  try {
    return window::run({words + 1, words + count});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "window: %s\n", error.what());
    return 1;
  }
}
