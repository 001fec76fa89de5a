// SPDX-License-Identifier: GPL-3.0-or-later
// Expressions in machine files: compiled as they are read, so that every mistake in them is found
// at its letter, and no variable stands for nothing.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/expression.h"
#include "machines/machine_spec.h"
#include "scene/table_reader.h"

namespace swage {

// What every expression sees of the work-piece: length, height, width, ...
const std::vector<std::string>& work_piece_names();
const std::vector<std::pair<std::string, std::string>>&
work_piece_names_told();  // and what each is

inline const std::string kStop = "stop";      // what motions call it
inline const std::string kNumber = "number";  // of a part that is repeated
inline const std::string kAlong = "along";    // a blade's edge, 0 to 1

class ExpressionReader {
  public:
    // The names that expressions see from now on, beside those of before.
    void add_name(const std::string& name) { known_.push_back(name); }
    void add_names(const std::vector<std::string>& names);
    // One that also sees what motions and strengths see beside all that: t and duration, and stop,
    // but for blades, whose cut is settled when they first touch.
    ExpressionReader timed(bool stops = true) const;
    // Why it sees no such name, instead of that it is unknown.
    using Unseen = std::map<std::string, std::string>;
    void explain(Unseen unseen) { unseen_ = std::move(unseen); }
    void explain(const std::string& name, const std::string& why) { unseen_[name] = why; }
    // One for a part that is repeated: it sees which one it is.
    ExpressionReader repeated() const;
    // One for an edge that is a curve: it sees how far along it is, and has named nothing yet.
    ExpressionReader curved() const;

    // Look up a number or an expression; `into` keeps its text. Return whether the key is there.
    bool read(TableReader& table, const std::string& key, Expression& into);
    bool read(TableReader& table, const std::string& key, Expression3& into);
    void read_item(TableReader& table, const std::string& key, const Node& item, Expression3& into);
    // The same for one that has to be of a quantity; what is no more than a number and a unit is
    // refused when its unit is another's, and an angle of more than a turn without one warned of.
    // What is certain already and larger than can be meant is refused.
    bool read(TableReader& table, const std::string& key, Quantity quantity, Expression& into);
    bool read(TableReader& table, const std::string& key, Quantity quantity, Expression3& into);
    void read_item(TableReader& table, const std::string& key, const Node& item, Quantity quantity,
                   Expression3& into);

    // Report where a length that stands there, when its value is already certain, is not more than
    // 0, or less than can be meant; or all of three are 0.
    void expect_positive(TableReader& table, const std::string& key);
    void expect_direction(TableReader& table);  // of its axis
    // The same where it is no whole number from 0 to `most`.
    void expect_count(TableReader& table, const std::string& key, int most);

    // Whether an expression uses no other names.
    bool sees_all_of(const Expression& text) const;
    // What another reader's expressions named counts as named here.
    void take_used(const ExpressionReader& other) {
        used_.insert(other.used_.begin(), other.used_.end());
    }
    // Whether some expression that was read names the variable.
    bool is_used(const std::string& name) const { return used_.contains(name); }

  private:
    std::optional<double> certain(const Node& node) const;  // no variable has a say in it
    void read_one(TableReader& table, const std::string& key, const Node& node, Expression& into);
    void expect_meant(TableReader& table, const std::string& key, const Node& node,
                      Quantity quantity, bool is_positive = false) const;
    void expect_unit(TableReader& table, const std::string& key, const Node& node,
                     Quantity quantity);

    std::vector<std::string> known_;
    Unseen unseen_;
    std::set<std::string> used_;
};

}  // namespace swage
