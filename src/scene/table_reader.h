// SPDX-License-Identifier: GPL-3.0-or-later
// Typed look-up in a table of a file. Every look-up makes its key known; a key that nothing asked
// for is reported, with the nearest known one and the section where it belongs.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/math.h"
#include "base/units.h"
#include "scene/document.h"

namespace swage {

inline Range above(double low) { return {.low = low, .low_open = true}; }
inline Range at_least(double low) { return {.low = low}; }
inline Range between(double low, double high) { return {.low = low, .high = high}; }
inline Range inside(double low, double high) { return {low, high, true, true}; }

// What a key may be given as, and what it is when left out.
struct KeyForm {
    std::string key;
    std::string takes;  // "length, more than 0 m"
    std::string usual;  // empty: nothing worth telling
};

struct MaterialCatalogue;

// What all tables of a file share.
struct Reading {
    explicit Reading(MistakeList& list) : mistakes(list) {}

    struct UnknownKey {
        std::string section, key;
        Place place;
        std::vector<std::string> known;
    };

    MistakeList& mistakes;
    bool is_complete = true;                             // see Document
    std::map<std::string, std::set<std::string>> known;  // section -> keys that were asked for
    std::vector<UnknownKey> unknown;
    std::map<const Node*, double> number;  // what texts were read as, in SI
    // With `describes`: the forms of all keys by section, both in the order in which they are
    // asked.
    bool describes = false;
    std::vector<std::pair<std::string, std::vector<KeyForm>>> forms;

    // Once a material was looked for by its name.
    std::shared_ptr<const MaterialCatalogue> materials;

    // Once, after everything was read.
    void report_unknown();
};

// What stands behind the number of a text that reads as a quantity: "MPa" of "250 MPa".
std::string_view unit_in(std::string_view text);

class TableReader {
  public:
    // `section` is how the user writes it: "[mesh]", "[[stage]]".
    TableReader(const Node& table, std::string section, Reading& reading);

    // Each sets `into` when the key is there and right, reports when it is there and wrong, and
    // returns whether it is there.
    bool quantity(const std::string& key, Quantity quantity, const Range& range, double& into);
    bool whole(const std::string& key, int low, int high, int& into);
    bool truth(const std::string& key, bool& into);
    bool text(const std::string& key, std::string& into);
    bool vector(const std::string& key, Quantity quantity, Vec3& into);
    bool ends(const std::string& key, Quantity quantity, std::array<double, 2>& into);

    template <typename T>
    bool choice(const std::string& key, const std::vector<std::pair<std::string, T>>& choices,
                T& into) {
        std::vector<std::string> names;
        std::string usual;
        for (const auto& [name, value] : choices) {
            names.push_back(name);
            if (value == into) usual = name;
        }
        const int chosen = chosen_name(key, names, usual);
        if (chosen >= 0) into = choices[static_cast<std::size_t>(chosen)].second;
        return find(key) != nullptr;
    }

    // The same of a value that stands inside that of a key; whether it is right.
    bool value(const std::string& key, const Node& node, Quantity quantity, const Range& range,
               double& into);

    const Node* find(const std::string& key);  // any kind; null when absent

    // What a look-up that is none of the above takes (see Reading::forms).
    void describe(const std::string& key, const std::string& takes, const std::string& usual = {});

    // The table under a key; an empty one when it is absent or no table.
    const Node& table(const std::string& key);
    // The tables of an array; `example` shows how one is written ("[[stage]]").
    std::vector<const Node*> tables(const std::string& key, const std::string& example);

    // Reports that the key is needed, unless lines of the file were lost.
    void missing(const std::string& key, const std::string& what);
    void mistake(const std::string& key, const std::string& text,
                 ExitCode code = ExitCode::scene);  // at the value, or at the table
    void warn(const std::string& key, const std::string& text);
    // Where an angle without a unit was meant in degrees.
    void warn_of_turns(const std::string& key, const Node& node, double angle);

    // Reports keys that nothing asked for.
    void finish();
    // They cannot be judged, as what would read them has failed.
    void leave_unknown() { judge_unknown_ = false; }

    const Place& place() const { return node_.place; }
    // What is looked up from now on belongs to this narrower section ("[[stage]] with ...").
    void narrow(std::string section);
    bool has_other_keys(const std::set<std::string>& than) const;
    Reading& reading() { return reading_; }

  private:
    void tell_known();
    void describe_quantity(const std::string& key, Quantity quantity, const Range& range,
                           double usual);
    int chosen_name(const std::string& key, const std::vector<std::string>& names,
                    const std::string& usual);
    bool number(const std::string& key, const Node& node, Quantity quantity, double& into);
    bool is_meant(const std::string& key, const Node& node, Quantity quantity, double value,
                  bool is_positive = false);

    const Node& node_;
    std::string section_;
    Reading& reading_;
    std::vector<std::string> asked_;
    std::size_t told_ = 0;  // of asked_, those that the reading knows of
    bool judge_unknown_ = true;
};

}  // namespace swage
