#pragma once

#include <string>

#include "firmware/eye_page/sections/page_data.hpp"
#include "hal/result.hpp"

/// What the rows of section_list.cpp draw, a file each: HTML, empty where the file has nothing of it. Errors: those of
/// tone_picture().
namespace compueye::firmware {

[[nodiscard]] hal::Result<std::string> channel_states(const PageData& data);
[[nodiscard]] hal::Result<std::string> error_budget_table(const PageData& data);
[[nodiscard]] hal::Result<std::string> light_map(const PageData& data);
[[nodiscard]] hal::Result<std::string> receptive_fields(const PageData& data);
[[nodiscard]] hal::Result<std::string> row_error_map(const PageData& data);
[[nodiscard]] hal::Result<std::string> chi2_map(const PageData& data);
[[nodiscard]] hal::Result<std::string> linearity_curve(const PageData& data);
[[nodiscard]] hal::Result<std::string> drift_curve(const PageData& data);
[[nodiscard]] hal::Result<std::string> sensor_table(const PageData& data);
[[nodiscard]] hal::Result<std::string> session_table(const PageData& data);
[[nodiscard]] hal::Result<std::string> capture_table(const PageData& data);
[[nodiscard]] hal::Result<std::string> provenance(const PageData& data);

}  // namespace compueye::firmware
