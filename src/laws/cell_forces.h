// SPDX-License-Identifier: GPL-3.0-or-later
// A cell's forces (laws/cell.h) as a sweep over many wants them, in as few operations as there
// are: factors that all cells share go into the moduli once, 4 a F stands for F, and a stress that
// is a function of the strain stays a series in it.
#pragma once

#include "laws/cell.h"
#include "laws/cell_back.h"
#include "laws/cell_foam.h"

namespace swage {

enum class CellKind {
    elastic,
    yielding,
    kinematic,  // yielding with a back stress
    rubber,
    foam
};

// Calls act.operator()<kKind>() for a kind that is known only now.
template <typename Act>
void by_kind(CellKind kind, const Act& act) {
    switch (kind) {
        case CellKind::elastic:
            return act.template operator()<CellKind::elastic>();
        case CellKind::yielding:
            return act.template operator()<CellKind::yielding>();
        case CellKind::kinematic:
            return act.template operator()<CellKind::kinematic>();
        case CellKind::rubber:
            return act.template operator()<CellKind::rubber>();
        case CellKind::foam:
            return act.template operator()<CellKind::foam>();
    }
}

inline constexpr bool can_flow(CellKind kind) {
    return kind == CellKind::yielding || kind == CellKind::kinematic;
}

// By the gradient itself, which shows where a cell is inside out, instead of by C = F^T F.
inline constexpr bool knows_inside(CellKind kind) {
    return kind == CellKind::rubber || kind == CellKind::foam;
}
// Elastic energy of the mean strain per volume of material, at gradient f, less what has flowed
// `strain`.
template <typename N>
SWAGE_INLINE N mean_energy(CellKind kind, const CellModuli& law, const Columns<N>& f,
                           const CellStrain<N>& strain) {
    return kind == CellKind::rubber ? rubber_energy(law, f)
           : kind == CellKind::foam ? foam_energy(law, f)
                                    : strain_energy(law, strain);
}

// What all cells share.
struct CellConstants {
    explicit CellConstants(const CellModuli& moduli) : law(moduli), folded(moduli) {
        const double volume = law.spacing * law.spacing * law.spacing;
        scale = 0.25 / law.spacing;
        gram = scale * scale;
        folded.shear *= -gram * volume;
        folded.bulk *= -gram * volume;
        folded.edge *= -gram;
        folded.diagonal *= -gram;
        const double lame = folded.bulk - 2.0 / 3 * folded.shear;
        rubber_rise = scale * (lame + folded.shear) * (scale * gram);
        rubber_rest = scale * (lame + 2 * folded.shear);
        foam_push = -scale * folded.shear;
    }
    CellModuli law;
    double scale;                     // s = 1 / 4a
    double gram;                      // s^2
    CellModuli folded;                // give the forces on the sums from D and F^T Q / s
    double rubber_rise, rubber_rest;  // of the factor of cof D, with det D
    double foam_push;                 // the same with J^-m
};

// What a partly filled cell has of its own.
template <typename N>
struct CellShare {
    N fill;
    Triple<N> at;  // centroid of the material, -1 to 1
};

// The last step: from the stress p of D and g of the modes to the forces on the sums. `d`, `p`: as
// what has flowed by `a` sees them.
template <bool kPart, bool kFlowed, typename N>
SWAGE_INLINE CornerSums<N> spread_stress(const CornerSums<N>& c, const Columns<N>& d,
                                         const Symmetric<N>& a, const CellShare<N>& share,
                                         Columns<N> p, const CellModes<N>& g) {
    p = {p.x + pulled_by(g.xy.x, g.yz.x, g.zx.x, g.xyz.x, c),
         p.y + pulled_by(g.xy.y, g.yz.y, g.zx.y, g.xyz.y, c),
         p.z + pulled_by(g.xy.z, g.yz.z, g.zx.z, g.xyz.z, c)};
    if constexpr (kFlowed) p = p * a;
    CornerSums<N> r{p.x, p.y, p.z, d * g.xy, d * g.yz, d * g.zx, d * g.xyz};
    if constexpr (kPart) add_levers(p, share.at, r);
    return r;
}

// What cell_forces() is built for: act.operator()<kPart, kFlowed>().
template <typename Act>
SWAGE_INLINE auto by_share(bool is_part, bool has_flowed, const Act& act) {
    if (is_part) {
        return has_flowed ? act.template operator()<true, true>()
                          : act.template operator()<true, false>();
    }
    return has_flowed ? act.template operator()<false, true>()
                      : act.template operator()<false, false>();
}

// Forces on the sums of the corners. kPart: the cell is partly filled; kFlowed: it has a history.
// What does not apply is not looked at. Numbers with a slope: of what turning does to the stress's
// force, their slope gets the share `turning`. `over`: gets how far what can yield is beyond that.
// `back`: of what has flowed and is kinematic.
template <CellKind kKind, bool kPart, bool kFlowed, typename N>
SWAGE_INLINE CornerSums<N> cell_forces(const CellConstants& k, const CornerSums<N>& c,
                                       const CellShare<N>& share, const CellHistory<N>& history,
                                       double turning = 1, std::type_identity_t<N>* over = nullptr,
                                       const BackStrain<std::type_identity_t<N>>* back = nullptr) {
    Columns<N> d = kPart ? centroid_sums(c, share.at) : Columns<N>{c.x, c.y, c.z};
    Symmetric<N> a;  // A
    if constexpr (kFlowed) {
        a = taken_back(history);
        d = d * a;
    }
    CellModes<N> modes = pulled_back(d, c);  // q / s
    if constexpr (kFlowed) modes = modes - (1 / k.scale) * history.modes;
    CellModes<N> g;  // stress of the modes
    Columns<N> p;    // of D
    Symmetric<N> stress;
    if constexpr (knows_inside(kKind)) {
        const Columns<N> cofactor = {cross(d.y, d.z), cross(d.z, d.x), cross(d.x, d.y)};
        N shear = k.folded.shear + N{};
        const N det = dot(d.x, cofactor.x);
        N pressure;
        if constexpr (kKind == CellKind::rubber) {
            pressure = k.rubber_rise * det - k.rubber_rest;
        } else {
            pressure = k.foam_push * foam_pressure(k.law, (k.scale * k.gram) * det);
        }
        g = mode_stress(k.folded, modes);
        if constexpr (kPart) {
            shear = share.fill * shear;
            pressure = share.fill * pressure;
            g = mode_fill(share.fill) * g;
        }
        p = {shear * d.x + pressure * cofactor.x, shear * d.y + pressure * cofactor.y,
             shear * d.z + pressure * cofactor.z};
    } else {
        const CellStrain<N> e =
            strain_of_sum(Symmetric<N>{k.gram * dot(d.x, d.x) + 1.0, k.gram * dot(d.y, d.y) + 1.0,
                                       k.gram * dot(d.z, d.z) + 1.0, k.gram * dot(d.x, d.y),
                                       k.gram * dot(d.y, d.z), k.gram * dot(d.z, d.x)});
        const CellSize<N> size = cell_size(e);
        N shear = (2 * k.folded.shear) + N{};
        N pressure = k.folded.bulk * size.log;
        if constexpr (kPart) {
            shear = share.fill * shear;
            pressure = share.fill * pressure;
        }
        if constexpr (kFlowed) {
            g = mode_stress(k.folded, a, modes);
        } else {
            g = mode_stress(k.folded, modes);
        }
        Symmetric<N> lent{};  // stress that is no function of E
        if constexpr (kKind == CellKind::kinematic && kFlowed) {
            const CellModes<N> beta = (1 / k.scale) * back->modes;
            const CellModes<N> of_beta = mode_stress(k.folded, a, beta);
            const Symmetric<N> distortion = deviator(e.log);
            N part = (-0.5 / (k.law.shear * k.law.spacing * k.law.spacing * k.law.spacing)) + N{};
            N kept_modes{};
            N flow = 1.0 + N{}, mode_energy{};
            if constexpr (kPart) {
                flow = mode_flow(share.fill);
                mode_energy = (flow - 1.0) * mode_share(share.fill) * product(g, modes);
                part = part * flow * mode_share(share.fill);
            }
            const BackReturn<N> r = return_with_back(
                k.law, contract(distortion, distortion) + part * product(g, modes),
                contract(distortion, back->strain) + part * product(of_beta, modes),
                contract(back->strain, back->strain) + part * product(of_beta, beta),
                history.alpha);
            if (over != nullptr) *over = r.over;
            kept_modes = 1.0 - flow * (1.0 - r.kept);
            if constexpr (kPart) {
                const ModesReturn<N> alone = return_modes<N>(k.law, r, mode_energy, history.alpha);
                if (over != nullptr) *over = larger(r.over, alone.over);
                kept_modes = kept_of_modes<N>(flow, r, alone);
            }
            lent = (shear * r.lent) * back->strain;
            shear = shear * r.kept;
            g = kept_modes * g + r.lent * of_beta;
        } else if constexpr (can_flow(kKind)) {
            const Symmetric<N> distortion = deviator(e.log);
            const N alpha = kFlowed ? history.alpha : N{}, mode_energy = -1.0 * product(g, modes);
            if constexpr (kPart) {
                const N flow = mode_flow(share.fill), of_it = mode_share(share.fill);
                const CellReturn<N> back = return_cell(k.law, contract(distortion, distortion),
                                                       flow * of_it * mode_energy, alpha);
                const ModesReturn<N> alone =
                    return_modes(k.law, back, (1.0 - flow) * of_it * mode_energy, alpha);
                if (over != nullptr) *over = larger(back.over, alone.over);
                shear = shear * back.kept;
                g = kept_of_modes(flow, back, alone) * g;
            } else {
                const CellReturn<N> back =
                    return_cell(k.law, contract(distortion, distortion), mode_energy, alpha);
                if (over != nullptr) *over = back.over;
                shear = shear * back.kept;
                g = back.kept * g;
            }
        }
        if constexpr (kPart) g = mode_fill(share.fill) * g;
        stress =
            evaluate(e, material_stress(e, shear * deviator_series(e)) + pressure * size.slope);
        if constexpr (kKind == CellKind::kinematic && kFlowed) {
            stress = stress + material_stress(e, lent);
        }
    }
    if constexpr (requires { c.x.x.slope; }) {
        const Columns<N> e = slope_scaled(d, turning);
        if constexpr (knows_inside(kKind)) {
            p = turning_scaled(p, d, turning);
        } else {
            p = e * stress;
        }
        return spread_stress<kPart, kFlowed>(slope_scaled(c, turning), e, a, share, p, g);
    } else {
        if constexpr (!knows_inside(kKind)) p = d * stress;
        return spread_stress<kPart, kFlowed>(c, d, a, share, p, g);
    }
}

}  // namespace swage
