#include "drivers/illuminator/display_light.hpp"

#define SDL_MAIN_HANDLED
#include <SDL.h>

#include <algorithm>
#include <string>

#include "drivers/illuminator/grey_levels.hpp"
#include "hal/try.hpp"

namespace compueye::illuminator {
namespace {

constexpr int levels = 256;
constexpr const char* place_name = "display";

tl::unexpected<hal::Error> failed(hal::ErrorCode code, const std::string& what) {
  return hal::fail(code, place_name, what + ": " + SDL_GetError());
}

tl::unexpected<hal::Error> gone(const std::string& what) {
  return hal::fail(hal::ErrorCode::disconnected, place_name, what + ", and the eye may have seen something else");
}

hal::Result<void> check_monitor(int monitor) {
  const int monitors = SDL_GetNumVideoDisplays();
  if (monitors < 1) return failed(hal::ErrorCode::unsupported, "there is no monitor");
  if (monitor >= 0 && monitor < monitors) return {};
  std::string there;
  for (int k = 0; k < monitors; ++k) {
    const char* name = SDL_GetDisplayName(k);
    there += (k > 0 ? ", " : "") + std::to_string(k) + (name != nullptr ? " (" + std::string(name) + ")" : "");
  }
  return hal::fail(hal::ErrorCode::not_found, place_name,
                   "has no monitor " + std::to_string(monitor) + "; there are " + there);
}

}  // namespace

hal::Result<std::unique_ptr<DisplayLight>> DisplayLight::create(const DisplaySettings& settings, hal::Clock& clock) {
  SDL_SetMainReady();
  SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");  // the program has its own
  SDL_SetHint(SDL_HINT_RENDER_SCALE_QUALITY, "nearest");
  SDL_SetHint(SDL_HINT_VIDEO_MINIMIZE_ON_FOCUS_LOSS, "0");
  if (SDL_InitSubSystem(SDL_INIT_VIDEO) != 0) {
    return failed(hal::ErrorCode::unsupported,
                  "cannot be opened here; call it from a desktop, or from a console whose user may use the graphics");
  }
  std::unique_ptr<DisplayLight> light(new DisplayLight(settings, clock));
  TRY(light->open());
  return light;
}

DisplayLight::DisplayLight(const DisplaySettings& settings, hal::Clock& clock)
    : settings_(settings),
      clock_(clock),
      description_{settings.rows, settings.cols, levels, 0},
      pixels_(static_cast<std::size_t>(settings.rows) * static_cast<std::size_t>(settings.cols)) {}

DisplayLight::~DisplayLight() {
  if (texture_ != nullptr) SDL_DestroyTexture(texture_);
  if (renderer_ != nullptr) SDL_DestroyRenderer(renderer_);
  if (window_ != nullptr) SDL_DestroyWindow(window_);
  SDL_QuitSubSystem(SDL_INIT_VIDEO);
}

hal::Result<void> DisplayLight::open() {
  TRY(check_monitor(settings_.monitor));
  SDL_Rect usable{};
  if (SDL_GetDisplayUsableBounds(settings_.monitor, &usable) != 0) return failed(hal::ErrorCode::io, "has no size");
  std::uint32_t flags = SDL_WINDOW_ALLOW_HIGHDPI;
  int width = usable.w, height = usable.h;
  if (settings_.in_window) {
    // Three quarters leave room for frames and panels.
    const auto fits =
        TRY(centred_picture(settings_.rows, settings_.cols, usable.w * 3 / 4, usable.h * 3 / 4, place_name));
    width = fits.width;
    height = fits.height;
  } else {
    flags |= SDL_WINDOW_FULLSCREEN_DESKTOP | SDL_WINDOW_BORDERLESS;
  }
  const int at = static_cast<int>(SDL_WINDOWPOS_CENTERED_DISPLAY(static_cast<unsigned>(settings_.monitor)));
  window_ = SDL_CreateWindow("COMPU-EYE calibration", at, at, width, height, flags);
  if (window_ == nullptr) return failed(hal::ErrorCode::io, "opens no window");
  renderer_ = SDL_CreateRenderer(window_, -1, SDL_RENDERER_PRESENTVSYNC);
  if (renderer_ == nullptr) renderer_ = SDL_CreateRenderer(window_, -1, SDL_RENDERER_SOFTWARE);
  if (renderer_ == nullptr) return failed(hal::ErrorCode::io, "draws nothing");
  texture_ = SDL_CreateTexture(renderer_, SDL_PIXELFORMAT_ARGB8888, SDL_TEXTUREACCESS_STREAMING, settings_.cols,
                               settings_.rows);
  if (texture_ == nullptr) return failed(hal::ErrorCode::io, "takes no picture");
  SDL_ShowCursor(SDL_DISABLE);
  return present();
}

hal::Result<void> DisplayLight::present() {
  int width = 0, height = 0;
  if (SDL_GetRendererOutputSize(renderer_, &width, &height) != 0) return failed(hal::ErrorCode::io, "has no size");
  place_ = TRY(centred_picture(settings_.rows, settings_.cols, width, height, place_name));
  const SDL_Rect where{place_.left, place_.top, place_.width, place_.height};
  const int pitch = settings_.cols * static_cast<int>(sizeof(std::uint32_t));
  for (int k = 0; k < 2; ++k) {
    if (SDL_UpdateTexture(texture_, nullptr, pixels_.data(), pitch) != 0 ||
        SDL_SetRenderDrawColor(renderer_, 0, 0, 0, SDL_ALPHA_OPAQUE) != 0 || SDL_RenderClear(renderer_) != 0 ||
        SDL_RenderCopy(renderer_, texture_, nullptr, &where) != 0) {
      return failed(hal::ErrorCode::io, "does not draw");
    }
    SDL_RenderPresent(renderer_);
  }
  stale_ = false;
  return {};
}

hal::Result<void> DisplayLight::look_at_events() {
  SDL_Event event;
  while (SDL_PollEvent(&event) != 0) {
    if (event.type == SDL_QUIT) return gone("the window was closed");
    if (event.type == SDL_DISPLAYEVENT && event.display.event == SDL_DISPLAYEVENT_DISCONNECTED) {
      return gone("a monitor was taken away");
    }
    if (event.type == SDL_RENDER_TARGETS_RESET || event.type == SDL_RENDER_DEVICE_RESET) stale_ = true;
    if (event.type != SDL_WINDOWEVENT || event.window.windowID != SDL_GetWindowID(window_)) continue;
    switch (event.window.event) {
      case SDL_WINDOWEVENT_CLOSE:
        return gone("the window was closed");
      case SDL_WINDOWEVENT_HIDDEN:
      case SDL_WINDOWEVENT_MINIMIZED:
        if (pictures_ > 0) return gone("the window was hidden");  // a renderer may make the new window once more
        break;
      case SDL_WINDOWEVENT_EXPOSED:
        stale_ = true;
        break;
      default:
        break;
    }
  }
  return {};
}

/// A window manager places and sizes a new window while its first picture is shown.
hal::Result<void> DisplayLight::look_at_window() {
  std::array<int, 4> now{};
  SDL_GetWindowPosition(window_, &now[0], &now[1]);
  SDL_GetWindowSize(window_, &now[2], &now[3]);
  if (pictures_ > 1 && lies_ && *lies_ != now) return gone("the window was moved or resized");
  lies_ = now;
  return {};
}

hal::Result<void> DisplayLight::attend() {
  TRY(look_at_events());
  TRY(look_at_window());
  return stale_ && pictures_ > 0 ? present() : hal::Result<void>();
}

hal::Result<std::int64_t> DisplayLight::show(std::span<const float> intensities) {
  TRY(check_size(description_, intensities, place_name));
  TRY(look_at_events());
  TRY(look_at_window());
  std::transform(intensities.begin(), intensities.end(), pixels_.begin(), [](float intensity) {
    constexpr std::uint32_t opaque = 0xFF000000U, every_colour = 0x010101U;
    return opaque | static_cast<std::uint32_t>(level_of(intensity, levels)) * every_colour;
  });
  pictures_ = std::min(pictures_ + 1, 2);
  TRY(present());
  return clock_.now_ns();
}

hal::Result<std::int64_t> DisplayLight::off() {
  const std::vector<float> black(pixels_.size(), 0.0F);
  return show(black);
}

}  // namespace compueye::illuminator
