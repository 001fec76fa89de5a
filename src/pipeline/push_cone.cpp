// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/push_cone.h"

#include <Eigen/QR>
#include <algorithm>

namespace swage {

std::optional<Wrench> left_over(const std::vector<Wrench>& push, const Wrench& wanted,
                                double enough) {
    constexpr int kMostTurns = 200;
    constexpr double kGain = 1e-9;
    std::vector<std::size_t> used;
    Eigen::VectorXd share;
    Wrench left = wanted;
    for (int turn = 0; turn < kMostTurns; ++turn) {
        if (left.norm() <= enough) return std::nullopt;
        std::size_t best = push.size();
        double most = kGain * wanted.norm();
        for (std::size_t n = 0; n < push.size(); ++n) {
            const double gain = push[n].dot(left);
            if (gain > most) most = gain, best = n;
        }
        if (best == push.size()) return left;
        if (std::ranges::find(used, best) != used.end()) return left;  // it comes to no more
        used.push_back(best);
        share.conservativeResize(Eigen::Index(used.size()));
        share[share.size() - 1] = 0;
        while (!used.empty()) {
            Eigen::MatrixXd columns(6, Eigen::Index(used.size()));
            for (std::size_t n = 0; n < used.size(); ++n) {
                columns.col(Eigen::Index(n)) = push[used[n]];
            }
            const Eigen::VectorXd next = columns.colPivHouseholderQr().solve(wanted);
            left = wanted - columns * next;
            if (next.minCoeff() > 0) {
                share = next;
                break;
            }
            double far = 1;
            for (Eigen::Index n = 0; n < next.size(); ++n) {
                if (next[n] <= 0) far = std::min(far, share[n] / (share[n] - next[n]));
            }
            share += far * (next - share);
            const double none = kGain * share.maxCoeff();
            std::vector<std::size_t> kept;
            std::vector<double> of;
            for (std::size_t n = 0; n < used.size(); ++n) {
                const Eigen::Index i = Eigen::Index(n);
                if (next[i] <= 0 && share[i] <= none) continue;
                kept.push_back(used[n]);
                of.push_back(share[i]);
            }
            used = kept;
            share = Eigen::Map<Eigen::VectorXd>(of.data(), Eigen::Index(of.size()));
        }
        if (used.empty()) left = wanted;
    }
    return std::nullopt;
}

}  // namespace swage
