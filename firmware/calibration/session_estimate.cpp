#include "firmware/calibration/session_estimate.hpp"

#include "firmware/calibration/estimate_record.hpp"
#include "firmware/calibration/plan_file.hpp"
#include "firmware/calibration/session_captures.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {

hal::Result<SessionEstimate> estimate_session(calib::EyeFile& file, const calib::StoredSession& session,
                                              const EstimateRequest& request, const calib::Progress& progress) {
  const calib::EyeIdentity& eye = file.eye();
  const calib::SessionPlan plan = TRY(parse_plan(session.begun.plan, file.path()));
  const SessionCaptures taken = TRY(session_captures(file, session, request.exposure_s));
  SessionEstimate made;
  made.sensor = TRY(calib::sensor_noise(taken.series, eye.geometry.ommatidia(), session.begun.bits));
  const calib::CodeNoise noise = code_noise(made.sensor, request.unit_lsb, saturated_code(plan, session.begun.bits));
  hal::ObjectPlane plane = eye.plane;
  plane.distance_mm = session.begun.distance_mm;
  calib::EstimateSettings settings;
  settings.threads = request.threads;
  made.rows = TRY(calib::estimate_response(taken.captures, noise, eye.geometry, plane, settings, progress));
  if (request.budget) made.budget = TRY(request.budget(made.rows, taken.captures.frames));
  EstimateOrigin origin;
  if (made.budget) origin.kappas = numbers_of(*made.budget);
  origin.sessions = {session.id};
  origin.program = request.program;
  origin.method = "hybrid";
  origin.plan = session.begun.plan;
  origin.distance_mm = session.begun.distance_mm;
  origin.made_unix_s = request.now_unix_s;
  made.id = TRY(store(made.rows, taken.captures.linearity, made.sensor, origin, file));
  return made;
}

}  // namespace compueye::firmware
