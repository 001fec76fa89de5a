// SPDX-License-Identifier: GPL-3.0-or-later
// What pushes the work-piece without being a body: the apparatus' loads, and gravity; and the work
// that they do. Forces on the surface keep their direction; a pressure follows the surface. On
// cells no longer whole, cut or broken, whose corners belong to different sides, both act by whole
// cells beside these, each on the side that its point lies on. One all round a piece leaves them
// out and presses on what was laid open instead (sim/laid_open.h). What is left alone
// (sim/free_pieces.h) is pushed by nothing, and no work is done on it.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "matter/aggregate.h"
#include "matter/drive.h"
#include "sim/laid_open.h"
#include "sim/settings.h"
#include "sim/torn_forces.h"

namespace swage {

struct LoadSum {
    Vec3 centre = Vec3::Zero();  // of the loaded area, or of mass [m]
    Vec3 force = Vec3::Zero();   // [N]
    Vec3 torque = Vec3::Zero();  // about the centre [N m]
    // By which the centre has moved since the stage began without anything having moved: what is
    // pushed is other than it was. The way of what is pushed is that of the centre without it [m].
    Vec3 jump = Vec3::Zero();
};

class LoadSet {
  public:
    // `body`: the matter's number among the bodies, by which loads name it.
    LoadSet(const Apparatus& apparatus, const SimSettings& settings, int body = 0);

    bool has_gravity() const { return gravity_ != Vec3::Zero(); }
    Vec3 gravity(const Drive& now) const { return now.gravity_strength * gravity_; }  // [m/s2]

    // Adds the loads' forces; gravity acts on mass and is left to whoever sums over particles.
    void add_forces(const Aggregate& matter, const Drive& now, Vec3Array& force) const;

    // These particles are left alone from now on. They lie as they did when last settled.
    void leave_alone(const Aggregate& matter, const std::vector<ParticleId>& particles);
    bool leaves_alone(ParticleId p) const {
        return !left_alone_.empty() && heavy_mass_[std::size_t(p)] == 0;
    }
    // Of each particle the mass that gravity acts on [kg].
    const std::vector<double>& heavy_mass(const Aggregate& matter) const {
        return left_alone_.empty() ? matter.particle_mass : heavy_mass_;
    }

    // The largest sum of force sizes that any one load, or gravity, asks for [N], of what is
    // left alone too.
    double size(const Aggregate& matter, const Drive& now) const;

    // Whether any of them grows less.
    bool eases(const Drive& from, const Drive& to) const;

    // Whether any of them, or gravity, has changed.
    bool is_stirred(const Drive& since, const Drive& now) const;

    // A blade or a crack has changed which cells are whole.
    void connections_changed(const Aggregate& matter);
    // The particles had these masses [kg] before a blade cut: no work is done by that.
    void masses_changed(const Aggregate& matter, const std::vector<double>& was);

    // The stage begins here; only the first call counts.
    void start(const Aggregate& matter, const Drive& now);
    // The state is settled. Adds to `work` [J], by load and then gravity, what each did on the way
    // from the state settled before: the mean of the forces at both ends, times the way.
    void commit(const Aggregate& matter, const Drive& now, std::vector<double>& work);

    // By load, then gravity where there is any, of what is pushed; zero for loads on another body.
    // The centre of what is left alone altogether stays where it was then.
    std::vector<LoadSum> sums(const Aggregate& matter, const Drive& now) const;
    std::size_t count() const { return apparatus_->load.size() + has_gravity(); }

    template <typename Io>
    void visit(Io& io) {  // what steps change
        bool parted = parted_ != nullptr;
        io(started_, parted, last_, left_alone_, heavy_mass_, centre_);
        Parted now = parted_ ? *parted_ : Parted{};
        if (parted) io(now);
        if constexpr (Io::kReads) {
            parted_ = parted ? std::make_shared<const Parted>(std::move(now)) : nullptr;
        }
    }

  private:
    // What has come of the surface since a blade or a crack has parted cells.
    struct Parted {
        std::vector<char> is_off;  // of each point, where anything presses: its cell is parted
        // Of each load's points, but for closed ones; empty: their own cells.
        std::vector<std::vector<PointCarriage>> bearer;
        Pieces pieces;
        std::vector<std::vector<OpenFace>> face;  // of each load

        template <typename Io>
        void visit(Io& io) {
            io(is_off, bearer, pieces, face);
        }
    };
    // Those laid open on pieces that it presses on all round. Wherever a load's points are listed
    // they follow these.
    std::span<const OpenFace> faces_of(const Load& load) const;
    std::vector<OpenFace> pressed(const Load& load, const Aggregate& matter, const Pieces& pieces,
                                  const std::vector<OpenFace>& open) const;

    // On each point of a load [N].
    std::vector<Vec3> forces_of(const Load& load, double strength, const Aggregate& matter) const;

    // Of each of a load's points that it acts on, what sums are weighed by; 0: it does not [m2, or
    // of a force, which was spread over what was there as it began: N].
    std::vector<double> areas_of(const Load& load, const Aggregate& matter) const;
    std::vector<Vec3> positions_of(const Load& load, const Aggregate& matter) const;
    // Of those that carry the n-th of a load's points, what is not left alone: its weights' sum,
    // and the sum of these times its places [m].
    struct Pushed {
        double share = 0;
        Vec3 moment = Vec3::Zero();
    };
    Pushed pushed(const Load& load, std::size_t n, const Aggregate& matter) const;
    std::vector<Vec3> moments_of(const Load& load, const Aggregate& matter) const;
    // Of each of a load's points what is pushed of it.
    struct Patches {
        std::vector<double> area;    // [m2]
        std::vector<Vec3> position;  // its middle [m]
        std::vector<double> share;   // of the whole point

        double all() const;
    };
    Patches patches_of(const Load& load, const Aggregate& matter) const;

    // By load, then gravity: of what is pushed.
    struct Centre {
        Vec3 place = Vec3::Zero();  // where nothing is: where it was last [m]
        Vec3 jump = Vec3::Zero();   // as LoadSum has it
        bool is_of_nothing = false;

        template <typename Io>
        void visit(Io& io) {
            io(place, jump, is_of_nothing);
        }
    };
    std::vector<Centre> centres(const Aggregate& matter) const;
    // After what is pushed has become other than it was with these.
    void keep_centres(const std::vector<Centre>& before, const Aggregate& matter);
    // NOTE: the points sample a closed surface, and their area vectors sum to nothing only nearly.
    // What is left would drive a free body, or a piece of it, for ever, so it is taken off.
    void balance(const Load& load, const Aggregate& matter, const std::vector<double>& area,
                 std::vector<Vec3>& force) const;

    // What carries the n-th of a load's points; null: its own cell.
    const PointCarriage* bearer_of(const Load& load, std::size_t n) const;
    bool is_off(const Load& load, std::size_t n) const;  // it presses on nothing
    // Of its patch now [m2].
    Vec3 area_vector(const Load& load, std::size_t n, const Aggregate& matter) const;

    // That the n-th of a load's points acts on.
    SurfacePoints::Carriers carriers(const Load& load, std::size_t n,
                                     const Aggregate& matter) const;

    // `force_at`: by force and point, where they acted before.
    void renew_last(const Aggregate& matter, const Parted* before,
                    const std::vector<std::vector<Vec3>>& force_at);

    bool pushes(const Load& load) const { return load.body == body_; }
    // Calls act(l, load) for each load on this body.
    template <typename Act>
    void for_each_load(const Act& act) const {
        for (std::size_t l = 0; l < apparatus_->load.size(); ++l) {
            if (pushes(apparatus_->load[l])) act(l, apparatus_->load[l]);
        }
    }
    std::size_t index_of(const Load& load) const {
        return std::size_t(&load - apparatus_->load.data());
    }

    const Apparatus* apparatus_;
    int body_;
    Vec3 gravity_;
    // When settled last: by load, then point; and for gravity.
    struct Settled {
        std::vector<std::vector<Vec3>> moment, force;  // of what is pushed; on the whole point
        Vec3 mass_moment = Vec3::Zero();               // sum of mass times position [kg m]
        Vec3 gravity = Vec3::Zero();

        template <typename Io>
        void visit(Io& io) {
            io(moment, force, mass_moment, gravity);
        }
    };
    Settled settled(const Aggregate& matter, const Drive& now) const;

    bool started_ = false;
    std::shared_ptr<const Parted> parted_;  // null: all cells are whole
    Settled last_;
    std::vector<ParticleId> left_alone_;
    std::vector<double> heavy_mass_;  // heavy_mass(), once anything is left alone
    std::vector<Centre> centre_;      // when what is pushed became other last; empty: it has not
};

}  // namespace swage
