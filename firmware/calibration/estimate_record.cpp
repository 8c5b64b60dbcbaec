#include "firmware/calibration/estimate_record.hpp"

#include <array>
#include <limits>
#include <optional>
#include <utility>

#include "firmware/eye/stored_rows.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

using calib::ChannelNoise;
using calib::NamedColumn;

double told(const std::optional<double>& figure) noexcept {
  return figure.value_or(std::numeric_limits<double>::quiet_NaN());
}

/// The figures of EMVA 1288 that are told of a channel, by name.
struct NoiseFigure {
  const char* name;
  std::optional<double> ChannelNoise::*member;
};
constexpr std::array<NoiseFigure, 7> noise_figures{{
    {"gain_lsb_per_e", &ChannelNoise::gain_lsb_per_e},
    {"dark_noise_lsb", &ChannelNoise::dark_noise_lsb},
    {"read_noise_e", &ChannelNoise::read_noise_e},
    {"dark_current_e_per_s", &ChannelNoise::dark_current_e_per_s},
    {"saturation_e", &ChannelNoise::saturation_e},
    {"linearity_error", &ChannelNoise::linearity_error},
    {"dynamic_range", &ChannelNoise::dynamic_range},
}};

void add_noise(const calib::SensorNoise& sensor, calib::Estimate& record) {
  for (const NoiseFigure& figure : noise_figures) {
    record.sensor.push_back({figure.name, told(sensor.median.*figure.member)});
    NamedColumn& column = record.channel_sensor.emplace_back(NamedColumn{figure.name, {}});
    for (const ChannelNoise& channel : sensor.channels) column.values.push_back(told(channel.*figure.member));
  }
  record.sensor.push_back({"dsnu_e", told(sensor.dsnu_e)});
  record.sensor.push_back({"prnu", told(sensor.prnu)});
}

}  // namespace

hal::Result<std::int64_t> store(const calib::ResponseEstimate& estimate,
                                const std::vector<calib::LinearityTable>& linearity, const calib::SensorNoise& sensor,
                                const EstimateOrigin& origin, calib::EyeFile& file) {
  calib::Estimate record;
  record.sessions = origin.sessions;
  record.made_unix_s = origin.made_unix_s;
  record.program = origin.program;
  record.method = origin.method;
  record.plan = origin.plan;
  record.distance_mm = origin.distance_mm;
  record.kappas = origin.kappas;
  add_rows(estimate, record);
  add_noise(sensor, record);
  if (!linearity.empty()) record.linearity_codes = linearity.front().code;
  for (const calib::LinearityTable& table : linearity) {
    record.linearity_values.insert(record.linearity_values.end(), table.straight.begin(), table.straight.end());
  }
  std::vector<float> sigma;
  for (const calib::RowEstimate& row : estimate.rows) {
    if (row.status == hal::ChannelStatus::good) sigma.insert(sigma.end(), row.sigmas.begin(), row.sigmas.end());
  }
  return file.store_estimate(record, TRY(estimate.response(file.eye().plane)), sigma);
}

}  // namespace compueye::firmware
