// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/read_parameters.h"

#include <algorithm>

#include "base/text.h"
#include "scene/read_load.h"
#include "scene/stage_keys.h"

namespace swage {

namespace {

bool is_work_piece_name(const std::string& name) {
    const std::vector<std::string>& names = work_piece_names();
    return std::find(names.begin(), names.end(), name) != names.end();
}

class ParametersReader {
  public:
    ParametersReader(Reading& reading, ExpressionReader& expression, ExpressionReader& counting)
        : mistakes_(reading.mistakes),
          reading_(reading),
          expression_(expression),
          counting_(counting) {}

    void read(const Node& all, MachineSpec& machine) {
        std::set<std::string> names;  // of this and those below
        for (const Entry& entry : all.entry) names.insert(entry.key);
        for (const Entry& entry : all.entry) {
            const std::string section = "[parameter." + entry.key + "]";
            expression_.explain(later(names));
            names.erase(entry.key);
            if (!check_parameter_name(entry)) continue;
            if (entry.value.kind != Node::Kind::table) {
                mistakes_.add(
                    entry.place,
                    fmt::format("write {} and, below it, quantity, default, low, high and help",
                                section));
                continue;
            }
            TableReader table(entry.value, section, reading_);
            ParameterSpec parameter;
            parameter.name = entry.key;
            std::vector<std::pair<std::string, Quantity>> quantities;
            for (const std::string& name : quantity_names()) {
                quantities.emplace_back(name, *quantity_named(name));
            }
            if (!table.choice("quantity", quantities, parameter.quantity)) {
                table.missing("quantity", joined(quantity_names(), ", "));
            }
            const Node* quantity = table.find("quantity");
            const bool is_known = quantity != nullptr && quantity->kind == Node::Kind::text &&
                                  quantity_named(quantity->text);
            const auto read = [&](const char* key, Expression& into) {
                return is_known ? expression_.read(table, key, parameter.quantity, into)
                                : expression_.read(table, key, into);
            };
            if (!read("default", parameter.default_value)) {
                table.missing("default", "the value if the scene gives none");
            } else if (counting_.sees_all_of(parameter.default_value)) {
                counting_.add_name(parameter.name);
            }
            read("low", parameter.low);
            read("high", parameter.high);
            check_range(table, parameter);
            table.text("help", parameter.help);
            table.finish();
            reading_.known.erase(section);  // its keys belong in every parameter: no hint
            expression_.add_name(parameter.name);
            machine.parameter.push_back(std::move(parameter));
        }
        expression_.explain({{kNumber, "only a part with repeat has one"}});
        explain_counts(machine);
    }

  private:
    static ExpressionReader::Unseen later(const std::set<std::string>& names) {
        ExpressionReader::Unseen unseen;
        for (const std::string& name : names) {
            unseen[name] = "a parameter can use only those above it";
        }
        return unseen;
    }

    void explain_counts(const MachineSpec& machine) {
        const std::string why =
            "repeat can use only parameters whose default does not depend on the work-piece";
        ExpressionReader::Unseen unseen;
        for (const std::string& name : work_piece_names()) unseen[name] = why;
        for (const ParameterSpec& parameter : machine.parameter) unseen[parameter.name] = why;
        counting_.explain(std::move(unseen));
    }

    bool check_parameter_name(const Entry& entry) {
        std::string reason;
        if (!is_part_name(entry.key)) {
            reason = "must be letters, digits and _, beginning with a letter";
        } else if (entry.key == "t") {
            reason = "is the time";
        } else if (entry.key == kStop) {
            reason = "is the time at which a limit is reached";
        } else if (entry.key == kNumber) {
            reason = "is the number of a repeated part";
        } else if (entry.key == kAlong) {
            reason = "is the way along a blade's edge";
        } else if (is_work_piece_name(entry.key)) {
            reason = "is a variable of the work-piece";
        } else if (is_reserved_name(entry.key)) {
            reason = "is a function, a constant or a unit";
        } else if (is_stage_key(entry.key)) {
            reason = "is a key of every [[stage]]";
        } else {
            return true;
        }
        mistakes_.add(entry.place, fmt::format("the parameter's name \"{}\" {}; choose another",
                                               entry.key, reason));
        return false;
    }

    // Where all three are plain numbers, they have to be in order.
    void check_range(TableReader& table, const ParameterSpec& parameter) {
        const auto certain = [](const Expression& text) -> std::optional<double> {
            try {
                if (!text.empty()) return evaluate_text(text.text, {});
            } catch (const TextError&) {
            }
            return std::nullopt;
        };
        const auto low = certain(parameter.low), high = certain(parameter.high);
        const auto value = certain(parameter.default_value);
        const auto shown = [&](double v) { return quantity_text(v, parameter.quantity); };
        if (low && high && *low > *high) {
            table.mistake(
                "low", fmt::format("low = {} is more than high = {}", shown(*low), shown(*high)));
        } else if ((low && value && *value < *low) || (high && value && *value > *high)) {
            table.mistake("default", fmt::format("default = {} is not in the range from {} to {}",
                                                 shown(*value), low ? shown(*low) : "anything",
                                                 high ? shown(*high) : "anything"));
        }
    }

    MistakeList& mistakes_;
    Reading& reading_;
    ExpressionReader& expression_;
    ExpressionReader& counting_;
};

}  // namespace

void read_parameters(const Node& all, Reading& reading, MachineSpec& machine,
                     ExpressionReader& expression, ExpressionReader& counting) {
    ParametersReader(reading, expression, counting).read(all, machine);
}

}  // namespace swage
