// SPDX-License-Identifier: GPL-3.0-or-later
// First by what lies next to where mass is wrong, so that waves and bending stay right. Weights of
// the cells' corners by the centroid of what they hold keep its centre. They are those of linear
// functions, whose second moment is h^2/6 too large along each axis: taking 1/12 of the second
// differences away again leaves none of it where all is smooth, and is Gregory's correction of the
// trapezoidal rule (5/12, 13/12, 1, ...) at an end. J. Gregory, letter to Collins, 1670.
//
// What limits and the next order leave is shared out over the whole body. The least change of
// masses, sum (m' - m)^2 / m, that gives ten moments is m' = m (1 + q) with a polynomial q of
// second degree in the place. Its ten coefficients are found by Newton's method on the clamped
// masses; Tikhonov's regularisation, iterated, leaves out what no change can reach: of a sheet of
// one cell all particles lie equally far from its middle.
//
// Clamped, that may find no masses which keep the centre where there are some: of tetrahedra, and
// of what has few cells. There the same is asked as a strictly convex problem, with mass and centre
// as conditions and second moments at a price. Its dual is concave and piecewise quadratic in the
// ten coefficients, and Newton's method with steps that gain climbs it from anywhere. L. Qi & J.
// Sun, A nonsmooth version of Newton's method, Math. Programming 58, 1993.
#include "mold/moments.h"

#include <Eigen/Dense>
#include <algorithm>
#include <limits>

#include "geometry/box.h"

namespace swage {

namespace {

using Moments = Eigen::Matrix<double, 10, 1>;  // of 1, x, y, z, xx, yy, zz, xy, yz, zx
using MomentMatrix = Eigen::Matrix<double, 10, 10>;
constexpr double kRegular = 1e-3;  // of a body of mass 1 that reaches from -1 to 1
constexpr int kRounds = 12;
constexpr double kClose = 1e-10;
constexpr double kLeastMass = 0.6, kMostMass = 2.5;  // of what a particle had
constexpr double kCentreMet = 1e-6;                  // [cells]
constexpr int kWidenings = 6;                        // of these bounds, twice each time
constexpr int kClimbs = 60, kHalvings = 40;
constexpr std::array kMissing = {1e-3, 1e-4, 1e-5};  // inverse prices of second moments
constexpr double kNear = 1e-8;                       // of the dual's slope, that is a solution
constexpr double kFirm = 1e-9;    // of the dual's curvature where hardly a mass may change
constexpr double kOfGain = 1e-4;  // of what a step promises, that is enough

Moments monomials(const Vec3& x) {
    Moments m;
    m << 1, x, x.cwiseProduct(x), x.x() * x.y(), x.y() * x.z(), x.z() * x.x();
    return m;
}

struct Scale {
    Vec3 middle, half;
    Vec3 operator()(const Vec3& x) const { return (x - middle).cwiseQuotient(half); }
};

// What one material has of a cell.
struct Part {
    double mass;    // [kg]
    Vec3 centroid;  // in the cell, each -0.5 to 0.5
};

template <typename Act>
void for_each_part(const Aggregate& matter, const Act& act) {
    const double volume = matter.lattice.cell_volume();
    for (const CellRun& run : matter.lattice.cell_run) {
        for (int n = 0; n < run.count; ++n) {
            const CellId cell = run.first + n;
            const MixedCell* mixed = matter.mixed_at(cell);
            if (mixed == nullptr) {
                const double density = matter.material_of(cell).density;
                act(run, n,
                    Part{volume * density * matter.cell_fill[cell],
                         matter.cell_centroid[cell].cast<double>()});
                continue;
            }
            for (int m : {0, 1}) {
                const double density = matter.material_at(mixed->material[m]).density;
                act(run, n,
                    Part{volume * density * mixed->fill[m], mixed->centroid[m].cast<double>()});
            }
        }
    }
}

// What lies off the cell's middle by d along an axis is taken
// to fill what is left symmetrically about it, 1 - 2 |d|: so it is where cells are cut along it.
Moments part_moments(const Vec3& cell_middle, double spacing, const Vec3& offset,
                     const Scale& scale) {
    Moments m = monomials(scale(cell_middle + spacing * offset));
    const Vec3 width = spacing * (Vec3::Ones() - 2 * offset.cwiseAbs());
    m.segment<3>(4) += width.cwiseQuotient(scale.half).cwiseAbs2() / 12;
    return m;
}

// Mass that goes along the lattice's edges, from the lower end to the upper one, by the lower one
// and axis [kg].
using Fluxes = std::array<std::vector<double>, 3>;

template <typename Act>
void for_each_edge(const Lattice& lattice, const Act& act) {
    for (const Span& span : lattice.span) {
        if (span.direction >= kEdgeCount) continue;
        for (int n = 0; n < span.count; ++n) act(span.direction, span.lower + n, span.upper + n);
    }
}

// No particle gives more than leaves it with the least that it must keep.
void carry(const Lattice& lattice, const Fluxes& flux, const std::vector<double>& least,
           std::vector<double>& mass) {
    std::vector<double> leaves(mass.size(), 0.0), share(mass.size(), 1.0);
    for_each_edge(lattice, [&](int axis, ParticleId lower, ParticleId upper) {
        const double goes = flux[axis][lower];
        leaves[goes > 0 ? lower : upper] += std::abs(goes);
    });
    for (std::size_t p = 0; p < mass.size(); ++p) {
        const double spare = std::max(mass[p] - least[p], 0.0);
        if (leaves[p] > spare) share[p] = spare / leaves[p];
    }
    for_each_edge(lattice, [&](int axis, ParticleId lower, ParticleId upper) {
        const double goes = flux[axis][lower] * share[flux[axis][lower] > 0 ? lower : upper];
        mass[lower] -= goes, mass[upper] += goes;
    });
}

// What each cell holds goes to where it lies, its weights linear in the place.
void carry_to_centroids(const std::vector<double>& least, Aggregate& matter) {
    Fluxes flux;
    for (auto& along : flux) along.assign(matter.particle_count(), 0.0);
    for_each_part(matter, [&](const CellRun& run, int n, const Part& part) {
        for (int c = 0; c < 8; ++c) {
            const ParticleId p = run.corner(n, c);
            for (int axis = 0; axis < 3; ++axis) {
                if ((c >> axis & 1) == 0) flux[axis][p] += part.mass * part.centroid[axis] / 4;
            }
        }
    });
    carry(matter.lattice, flux, least, matter.particle_mass);
}

// Takes 1/12 of second differences of the mass away. Beyond the last particles there are none that
// could take their part: it goes one further in, which is as much for second moments.
void sharpen(const std::vector<double>& least, Aggregate& matter) {
    std::vector<double>& mass = matter.particle_mass;
    std::array<std::vector<char>, 3> has_lower, has_upper;
    Fluxes flux;
    for (int axis = 0; axis < 3; ++axis) {
        has_lower[axis].assign(mass.size(), 0), has_upper[axis].assign(mass.size(), 0);
        flux[axis].assign(mass.size(), 0.0);
    }
    for_each_edge(matter.lattice, [&](int axis, ParticleId lower, ParticleId upper) {
        has_upper[axis][lower] = has_lower[axis][upper] = 1;
    });
    for_each_edge(matter.lattice, [&](int axis, ParticleId lower, ParticleId upper) {
        const double up = has_upper[axis][upper] ? mass[upper] : 0,
                     down = has_lower[axis][lower] ? mass[lower] : 0;
        flux[axis][lower] = (up - down) / 12;
    });
    carry(matter.lattice, flux, least, mass);
}

// The change of q that makes up for what is missing of the moments. Mass and centre are kept
// whatever becomes of the second moments, some of which none may reach.
Moments correction(const MomentMatrix& slope, const Moments& missing) {
    const Eigen::LDLT<Eigen::Matrix4d> first(slope.topLeftCorner<4, 4>());
    const Eigen::Matrix<double, 4, 6> both = slope.topRightCorner<4, 6>();
    const Eigen::Matrix<double, 6, 6> second = slope.bottomRightCorner<6, 6>() -
                                               both.transpose() * first.solve(both) +
                                               kRegular * Eigen::Matrix<double, 6, 6>::Identity();
    Moments q;
    q.tail<6>() =
        second.ldlt().solve(missing.tail<6>() - both.transpose() * first.solve(missing.head<4>()));
    q.head<4>() = first.solve(missing.head<4>() - both * q.tail<6>());
    return q;
}

// Between these a particle's mass stays [kg].
struct Bounds {
    std::vector<double> least, most;

    // `wide`: 1 or more.
    static Bounds about(const std::vector<double>& mass, double wide) {
        Bounds bounds;
        for (double m : mass) {
            bounds.least.push_back(kLeastMass / wide * m);
            bounds.most.push_back(kMostMass * wide * m);
        }
        return bounds;
    }
};

// What the masses of a body are changed by.
struct Change {
    Aggregate& matter;
    const Bounds& bounds;
    Scale scale;
    Moments wanted;

    Moments at(std::size_t p) const { return monomials(scale(matter.particle_position.at(p))); }
    double mass_of(std::size_t p, double grows) const {
        return std::clamp(matter.particle_mass[p] * (1 + grows), bounds.least[p], bounds.most[p]);
    }
    bool is_free(std::size_t p, double mass) const {
        return mass > bounds.least[p] && mass < bounds.most[p];
    }
    void apply(const Moments& q) {
        double sum = 0;
        for (std::size_t p = 0; p < matter.particle_count(); ++p) {
            sum += matter.particle_mass[p] = mass_of(p, q.dot(at(p)));
        }
        for (double& m : matter.particle_mass) m *= wanted[0] / sum;
    }
};

Moments least_change(const Change& change) {
    const double mass = change.wanted[0];
    Moments q = Moments::Zero(), best = q;
    double least_left = std::numeric_limits<double>::infinity();
    for (int round = 0; round < kRounds; ++round) {
        Moments have = Moments::Zero();
        MomentMatrix slope = MomentMatrix::Zero();
        for (std::size_t p = 0; p < change.matter.particle_count(); ++p) {
            const Moments m = change.at(p);
            const double own = change.mass_of(p, q.dot(m));
            have += own * m;
            if (change.is_free(p, own)) {
                slope += change.matter.particle_mass[p] * m * m.transpose();
            }
        }
        const double left = (change.wanted - have).norm() / mass;
        if (left < least_left) best = q, least_left = left;
        if (left < kClose) break;
        q += correction(slope / mass, (change.wanted - have) / mass);
    }
    return best;
}

// The dual at some coefficients.
struct Dual {
    double value = 0;
    Moments slope = Moments::Zero();
    MomentMatrix curvature = MomentMatrix::Zero();  // its negative
};

Dual dual_at(const Change& change, double missing, const Moments& q) {
    const double mass = change.wanted[0];
    Dual dual;
    for (std::size_t p = 0; p < change.matter.particle_count(); ++p) {
        const Moments m = change.at(p);
        const double grows = q.dot(m), was = change.matter.particle_mass[p],
                     own = change.mass_of(p, grows), more = own - was;
        dual.value -= own * grows - 0.5 * more * more / was;
        dual.slope -= own * m;
        if (change.is_free(p, own)) dual.curvature += was * m * m.transpose();
    }
    dual.value = (dual.value + change.wanted.dot(q)) / mass;
    dual.slope = (dual.slope + change.wanted) / mass;
    dual.curvature /= mass;
    dual.value -= 0.5 * missing * q.tail<6>().squaredNorm();
    dual.slope.tail<6>() -= missing * q.tail<6>();
    dual.curvature.diagonal().tail<6>().array() += missing;
    dual.curvature.diagonal().array() += kFirm;
    return dual;
}

// Where there are masses within the bounds that keep the centre these are found; their second
// moments as near as prices let them come that climb as the first does.
Moments climbed(const Change& change) {
    Moments best = Moments::Zero();
    for (double missing : kMissing) {
        Moments q = best;
        Dual here = dual_at(change, missing, q);
        for (int climb = 0; climb < kClimbs && here.slope.norm() > kClose; ++climb) {
            const Moments way = here.curvature.ldlt().solve(here.slope);
            const double gain = way.dot(here.slope);
            double part = 1;
            for (int n = 0; n < kHalvings; ++n, part /= 2) {
                const Dual there = dual_at(change, missing, q + part * way);
                const bool gains = there.value >= here.value + kOfGain * part * gain;
                if (!gains && !(there.slope.norm() < 0.5 * here.slope.norm())) continue;
                q += part * way, here = there;
                break;
            }
        }
        if (!(here.slope.norm() < kNear)) break;
        best = q;
    }
    return best;
}

Moments wanted_moments(const Aggregate& matter, const Scale& scale) {
    const double spacing = matter.lattice.spacing;
    Moments wanted = Moments::Zero();
    for_each_part(matter, [&](const CellRun& run, int n, const Part& part) {
        const Vec3 middle = matter.particle_position.at(run.row[0] + n).array() + 0.5 * spacing;
        wanted += part.mass * part_moments(middle, spacing, part.centroid, scale);
    });
    return wanted;
}

}  // namespace

double match_moments(Aggregate& matter) {
    const std::vector<double> shared = matter.particle_mass;
    Box box;
    for (std::size_t p = 0; p < matter.particle_count(); ++p) {
        box.grow(matter.particle_position.at(p));
    }
    const Scale scale{box.center(), 0.5 * (box.high - box.low)};
    const Moments wanted = wanted_moments(matter, scale);
    const auto missed = [&] {  // [cells]
        Vec3 first = Vec3::Zero();
        for (std::size_t p = 0; p < matter.particle_count(); ++p) {
            first += matter.particle_mass[p] * scale(matter.particle_position.at(p));
        }
        const Vec3 by = (first - wanted.segment<3>(1)) / wanted[0];
        return by.cwiseProduct(scale.half).norm() / matter.lattice.spacing;
    };
    const auto start = [&](const Bounds& bounds) {
        matter.particle_mass = shared;
        carry_to_centroids(bounds.least, matter);
        sharpen(bounds.least, matter);
        return Change{matter, bounds, scale, wanted};
    };
    Bounds bounds = Bounds::about(shared, 1);
    Change change = start(bounds);
    change.apply(least_change(change));
    double wide = 1;
    for (int n = 0; n < kWidenings && !(missed() < kCentreMet); ++n, wide *= 2) {
        bounds = Bounds::about(shared, wide);
        Change again = start(bounds);
        again.apply(climbed(again));
    }
    return missed();
}

}  // namespace swage
