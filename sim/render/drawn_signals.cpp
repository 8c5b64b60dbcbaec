#include "sim/render/drawn_signals.hpp"

#include "hal/try.hpp"
#include "sim/render/renderer.hpp"

namespace compueye::sim {

hal::Result<std::vector<double>> drawn_signals(const hal::EyeGeometry& eye, const hal::ObjectPlane& object,
                                               const Scene& scene) {
  // Nothing may be sized by a geometry that is not valid.
  TRY(eye.validate());
  const RenderSettings everything_off{.tolerance = drawn_signal_tolerance};
  Renderer renderer = TRY(Renderer::create(eye, object, OpticsAsBuilt::drawn(eye), everything_off, scene));
  std::vector<double> signals(static_cast<std::size_t>(eye.ommatidia()));
  renderer.render(0.0, signals);
  return signals;
}

}  // namespace compueye::sim
