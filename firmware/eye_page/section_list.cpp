#include "firmware/eye_page/section_list.hpp"

#include <array>

#include "firmware/eye_page/sections/sections.hpp"

namespace compueye::firmware {
namespace {

constexpr std::array<PageSection, 12> sections{{
    {"channels", "Channels",
     "Marks are channels whose rows reach no solver. Single ones are borne; a whole row or column of them is a cable "
     "or "
     "a converter, and marks that crowd at one side are light that does not get there.",
     "No estimate says what the channels are.", channel_states},
    {"budget", "What a picture is off by",
     "The largest part is what to work on: rows become better by more patterns, misfit does not; noise goes down with "
     "light "
     "and exposure; what is left without any of these, with another eye. All of it is an estimate, good to a factor of "
     "three, for the board's own scene and solver.",
     "No estimate in this file was asked what its errors do to pictures.", error_budget_table},
    {"light", "Light from each pixel",
     "How much of every pixel of the object plane all ommatidia see together. It should fall off evenly towards the "
     "rim; "
     "a dent is what no reconstruction sees well, a step is a masked channel.",
     "No estimate has rows.", light_map},
    {"fields", "Receptive fields",
     "A dozen rows of the response, evenly spread over the eye, each in its own scale, its largest entry in brackets. "
     "Each should be one soft disc, "
     "whole but for the plane's rim; specks beside it are noise that the estimate took for response.",
     "No estimate has rows.", receptive_fields},
    {"row-error", "How well the rows are known",
     "Norm of a row's stated sigmas over that of its entries. It should be much alike everywhere, larger where fields "
     "are cut by the rim; single dark cells are dust under an edge or a channel that is about to fail.",
     "No estimate states sigmas.", row_error_map},
    {"chi2", "Misfit",
     "chi^2 a point of the patterns that were held out, which is one where rows and noise explain everything. A few is "
     "well; tens say that the model of a row lacks something, and that sigmas are wide for that.",
     "No estimate was judged by patterns held out.", chi2_map},
    {"linearity", "Linearity",
     "How far a code is from where a linear channel would have it. Nought is straight; a bow is the converter's, and "
     "is "
     "taken off before anything is solved; a wide band says that channels bow differently.",
     "No estimate has linearity tables: every channel was straight, or the session had no ramp.", linearity_curve},
    {"drift", "Drift",
     "White between the patterns, against the first of its session. It is divided out, if it moves slowly: a smooth "
     "curve is well, steps or a scatter beyond a tenth of the row error are a lamp or a mount to see to.",
     "No session has white between its patterns.", drift_curve},
    {"sensor", "The sensor by EMVA 1288",
     "Not determined is an answer: the photon transfer needs light that shot noise shows in, several levels of it, and "
     "two exposures for the dark current. PRNU has the optics in it.",
     "No estimate characterises the sensor.", sensor_table},
    {"sessions", "Sessions",
     "One that was cut off goes on with calibrate --resume. Serial and configuration are what the device said.",
     "The file has no session: its rows came from elsewhere.", session_table},
    {"captures", "Captures",
     "Retakes are frames lost, overrun or saturated on the way; more than a few in a hundred are a cable or a hub.",
     "The file has no captures.", capture_table},
    {"provenance", "Where it all comes from", "The hash of the captures changes with every raw code.",
     "The file has no estimate.", provenance},
}};

}  // namespace

std::span<const PageSection> page_sections() noexcept {
  return sections;
}

}  // namespace compueye::firmware
