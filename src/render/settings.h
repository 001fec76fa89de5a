// SPDX-License-Identifier: GPL-3.0-or-later
// What a user may ask of the pictures. Angles in radians, lengths in m.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "base/math.h"
#include "matter/skin_field.h"
#include "render/frame_rate.h"

namespace swage {

// What is upward in the pictures; automatic is y where nobody says otherwise.
enum class Up { automatic, x, y, z, minus_x, minus_y, minus_z };
inline constexpr std::array<const char*, 7> kUpName = {"auto", "x",  "y", "z",
                                                       "-x",   "-y", "-z"};  // in that order

enum class GlProviderKind { automatic, osmesa, egl };
inline constexpr std::array<const char*, 3> kGlName = {"auto", "osmesa", "egl"};  // in that order

// What is behind the bodies: paper, or nothing, and of the ground its shadows alone.
enum class Background { studio, transparent };
inline constexpr std::array<const char*, 2> kBackgroundName = {"studio", "transparent"};

// Beside each still. Without blending: how far away what is seen is, whose it is, its normal, where
// it goes and whose piece it is; and blended as the still is, its light.
enum class PicturePass { depth, matte, normal, motion, beauty, piece };
inline constexpr std::array<const char*, 6> kPassName = {"depth",  "matte",  "normal",
                                                         "motion", "beauty", "piece"};
inline bool is_colored(PicturePass pass) {  // a PNG, with a table of its colours
    return pass == PicturePass::matte || pass == PicturePass::piece;
}

// Where the lamp stands that throws the shadows; the others turn with it about up.
struct LightPlace {
    double azimuth = -0.80;   // from the film's first view, toward its right
    double elevation = 0.90;  // above the horizon, 5 degrees to pi/2
};

// A camera that looks at the framed action from an angle. `at` is the share of the film, 0 to 1;
// between keys the values move smoothly.
struct CameraKey {
    double at = 0;
    double azimuth = 0.6;     // about up, from the world's +z toward +x where y is up
    double elevation = 0.35;  // above the horizon, -pi/2 to pi/2
    double zoom = 1.0;        // 1 frames the bodies' whole way; 2 is twice as near; > 0
    // Eye and target: these instead of azimuth, elevation and zoom. A target alone: what the camera
    // looks at from there, instead of the middle of the action.
    std::optional<Vec3> eye, target;
};

// Angles of the camera that nobody gave: it may stand elsewhere, where more is to be seen.
struct OpenAngles {
    bool azimuth = false, elevation = false;
    bool any() const { return azimuth || elevation; }
};

struct RenderSettings {
    int width = 1280, height = 720;                 // 1 to 16384
    double field_of_view = 0.6;                     // vertical, 0 to pi exclusive
    std::vector<CameraKey> camera = {CameraKey{}};  // sorted by `at`
    OpenAngles open;                                // of that
    bool follow = false;                            // the camera goes along with the bodies
    FrameRate frame_rate;                           // of the film
    int first_frame = 1;                            // what the first is called, from 1 on
    bool film = true;                               // also write film.mp4, of what is not clear
    bool tools = true;                              // draw tools, grips and blades
    std::vector<std::string> hide;                  // of these, those that are not drawn
    bool ground = true;
    Background background = Background::studio;
    LightPlace light;
    Up up = Up::automatic;
    GlProviderKind gl = GlProviderKind::automatic;
    std::optional<SkinField> color;                    // bodies by it; none: as they look
    std::optional<std::array<double, 2>> color_range;  // of its scale, ascending, SI
    bool legend = true;                                // of that, on the still
    // Of the height, that the framed action is kept off at the bottom, for a legend; 0 to 0.5.
    double free_below = 0;
    std::vector<PicturePass> passes;  // each at most once

    bool has(PicturePass pass) const {
        return std::find(passes.begin(), passes.end(), pass) != passes.end();
    }

    bool has_film() const { return film && background != Background::transparent; }
};

}  // namespace swage
