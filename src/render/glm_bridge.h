// SPDX-License-Identifier: GPL-3.0-or-later
// The matrices and vectors that OpenGL takes are glm's; positions and turns come from Eigen. The
// only file that names glm's headers. Both store columns.
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>

#include "base/math.h"

namespace swage {

inline glm::dvec3 to_glm(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
inline glm::dquat to_glm(const Quat& q) { return {q.w(), q.x(), q.y(), q.z()}; }
inline Mat3 from_glm(const glm::mat3& m) {
    return Eigen::Map<const Eigen::Matrix3f>(glm::value_ptr(m)).cast<double>();
}

}  // namespace swage
