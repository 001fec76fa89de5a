// SPDX-License-Identifier: GPL-3.0-or-later
// muparser computes. Before it sees a text, every word, number and unit of it is looked up here, so
// that mistakes are named in our words and at their place, and so that what muparser would let pass
// (assignments, several results parted by commas) is refused.
#include "base/expression.h"

#include <muParser.h>

#include <algorithm>
#include <cmath>
#include <mutex>

#include "base/ascii.h"
#include "base/math.h"
#include "base/portable_math.h"
#include "base/suggest.h"
#include "base/units.h"

namespace swage {

namespace {

constexpr std::size_t kLongest = 4096;  // bytes of a formula
constexpr int kDeepest = 100;           // brackets in brackets

double line(double t, double a, double b) {
    if (t <= a) return b <= a && t == a ? 1 : 0;  // no width: a step
    return t >= b ? 1 : (t - a) / (b - a);
}
double ramp(double t, double a, double b) {
    const double s = line(t, a, b);
    return s * s * (3 - 2 * s);
}
double step(double t, double a) { return t < a ? 0 : 1; }
double clamp(double x, double a, double b) { return std::max(a, std::min(b, x)); }
// As a product where it is one.
double power(double x, double y) {
    return y == 2 ? x * x : y == 3 ? x * x * x : portable::pow(x, y);
}
double sign(double x) { return x > 0 ? 1 : x < 0 ? -1 : 0; }
double smallest(const double* x, int count) { return *std::min_element(x, x + count); }
double largest(const double* x, int count) { return *std::max_element(x, x + count); }

using One = double (*)(double);
using Two = double (*)(double, double);
using Three = double (*)(double, double, double);
using Many = double (*)(const double*, int);

struct Function {
    const char* name;
    One one = nullptr;
    Two two = nullptr;
    Three three = nullptr;
    Many many = nullptr;
    const char* arguments;
    const char* help;
};

const Function kFunctions[] = {
    {.name = "ramp",
     .three = ramp,
     .arguments = "ramp(t, a, b)",
     .help = "0 before a, 1 after b, smooth in between"},
    {.name = "line",
     .three = line,
     .arguments = "line(t, a, b)",
     .help = "0 before a, 1 after b, linear in between"},
    {.name = "step", .two = step, .arguments = "step(t, a)", .help = "0 before a, 1 from a on"},
    {.name = "clamp",
     .three = clamp,
     .arguments = "clamp(x, a, b)",
     .help = "x, limited to the range a to b"},
    {.name = "min",
     .many = smallest,
     .arguments = "min(a, b, ...)",
     .help = "the smallest of any number of values"},
    {.name = "max",
     .many = largest,
     .arguments = "max(a, b, ...)",
     .help = "the largest of any number of values"},
    {.name = "abs", .one = std::fabs, .arguments = "abs(x)", .help = "absolute value"},
    {.name = "sign", .one = sign, .arguments = "sign(x)", .help = "-1, 0 or 1"},
    {.name = "floor", .one = std::floor, .arguments = "floor(x)", .help = "rounded down"},
    {.name = "ceil", .one = std::ceil, .arguments = "ceil(x)", .help = "rounded up"},
    {.name = "round", .one = std::round, .arguments = "round(x)", .help = "nearest whole number"},
    {.name = "mod",
     .two = std::fmod,
     .arguments = "mod(x, y)",
     .help = "remainder of x divided by y"},
    {.name = "sqrt", .one = std::sqrt, .arguments = "sqrt(x)", .help = "square root"},
    {.name = "exp", .one = portable::exp, .arguments = "exp(x)", .help = "e to the power x"},
    {.name = "log", .one = portable::log, .arguments = "log(x)", .help = "natural logarithm"},
    {.name = "pow", .two = power, .arguments = "pow(x, y)", .help = "the same as x ^ y"},
    {.name = "hypot",
     .two = portable::hypot,
     .arguments = "hypot(x, y)",
     .help = "square root of x^2 + y^2"},
    {.name = "sin", .one = portable::sin, .arguments = "sin(x)", .help = "sine of an angle"},
    {.name = "cos", .one = portable::cos, .arguments = "cos(x)", .help = "cosine of an angle"},
    {.name = "tan", .one = portable::tan, .arguments = "tan(x)", .help = "tangent of an angle"},
    {.name = "asin", .one = portable::asin, .arguments = "asin(x)", .help = "arc sine"},
    {.name = "acos", .one = portable::acos, .arguments = "acos(x)", .help = "arc cosine"},
    {.name = "atan", .one = portable::atan, .arguments = "atan(x)", .help = "arc tangent"},
    {.name = "atan2",
     .two = portable::atan2,
     .arguments = "atan2(y, x)",
     .help = "angle of the direction (x, y)"},
};

const Function* function_named(std::string_view name) {
    for (const Function& one : kFunctions) {
        if (name == one.name) return &one;
    }
    return nullptr;
}

// For x ^ y: muparser's own sign is the C library's pow, whose last bits differ between libraries.
constexpr const char* kPower = "#";

mu::Parser make_parser() {
    mu::Parser parser;
    parser.ClearFun();
    parser.ClearConst();
    parser.DefineConst("pi", kPi);
    for (const Function& f : kFunctions) {
        if (f.one != nullptr) parser.DefineFun(f.name, f.one);
        if (f.two != nullptr) parser.DefineFun(f.name, f.two);
        if (f.three != nullptr) parser.DefineFun(f.name, f.three);
        if (f.many != nullptr) parser.DefineFun(f.name, f.many);
    }
    parser.DefineOprt(kPower, power, mu::prPOW, mu::oaRIGHT);
    return parser;
}

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

// Reads a formula from left to right and writes it again for muparser, with units worked in.
class Reader {
  public:
    Reader(std::string_view text, const std::vector<std::string>& variables)
        : text_(text), variables_(variables), is_used_(variables.size(), false) {}

    void read() {
        if (text_.size() > kLongest) refuse(kLongest, "the expression is too long");
        for (skip_blanks(); at_ < text_.size(); skip_blanks()) {
            if (const auto number = leading_number(at_)) {
                read_number(*number);
            } else if (begins_word(text_[at_])) {
                read_word();
            } else {
                read_sign();
            }
        }
        if (written_.empty()) refuse(0, "the expression is empty");
        if (!bracket_.empty()) refuse(bracket_.back().at, "this bracket is not closed");
    }

    const std::string& written() const { return written_; }
    // Where in the text what was written at `at` comes from.
    std::size_t origin(int at) const {
        if (at < 0 || static_cast<std::size_t>(at) >= origin_.size()) return text_.size();
        return origin_[static_cast<std::size_t>(at)];
    }
    const std::vector<bool>& is_used() const { return is_used_; }

  private:
    struct Bracket {
        std::size_t at;
        bool of_function;
        bool compares = false;  // in what is read of it, since the last && or other part of it
    };

    [[noreturn]] static void refuse(std::size_t at, const std::string& sentence) {
        throw TextError(at, sentence);
    }

    // Blanks that part words are kept.
    void skip_blanks() {
        if (at_ < text_.size() && is_blank(text_[at_]) && !written_.empty()) write(" ", at_);
        while (at_ < text_.size() && is_blank(text_[at_])) ++at_;
    }

    std::optional<LeadingNumber> leading_number(std::size_t at) const {
        const std::string_view rest = text_.substr(at);
        if (rest[0] == '+' || rest[0] == '-' || begins_word(rest[0])) return std::nullopt;
        try {
            return swage::leading_number(rest);
        } catch (const TextError& error) {
            refuse(at + error.at(), error.what());
        }
    }

    std::string_view word_at(std::size_t begin) const {
        std::size_t end = begin;
        while (end < text_.size() && goes_on_word(text_[end])) ++end;
        return text_.substr(begin, end - begin);
    }

    void write(std::string_view what, std::size_t from) {
        written_ += what;
        origin_.resize(written_.size(), from);
    }

    bool is_variable(std::string_view word) const {
        return std::find(variables_.begin(), variables_.end(), word) != variables_.end();
    }

    void read_number(const LeadingNumber& number) {
        const std::size_t from = at_;
        at_ += number.size;
        std::size_t next = at_;
        while (next < text_.size() && is_blank(text_[next])) ++next;
        double value = number.value;
        const bool has_word = next < text_.size() && begins_word(text_[next]);
        const std::string_view word = has_word ? word_at(next) : std::string_view();
        const auto unit = leading_unit(text_.substr(next));
        if (unit && !is_variable(word)) {
            value = in_si(text_.substr(from, number.size), *unit);
            at_ = next + unit->size;
            refuse_power_of_unit(text_.substr(from, number.size), text_.substr(next, unit->size));
        } else if (is_variable(word) || function_named(word) != nullptr || word == "pi") {
            refuse(next,
                   fmt::format("an operator is missing before \"{0}\"; to multiply write {1}*{0}",
                               word, text_.substr(from, number.size)));
        } else if (has_word) {
            refuse(next, fmt::format("unknown unit \"{}\"", word));
        }
        write(fmt::format("({:.17g})", value), from);
    }

    // Of "3 cm^2" some would expect 9 and some 3 square centimetres.
    void refuse_power_of_unit(std::string_view number, std::string_view unit) const {
        std::size_t next = at_;
        while (next < text_.size() && is_blank(text_[next])) ++next;
        if (next == text_.size() || text_[next] != '^') return;
        refuse(
            next,
            fmt::format(
                "this could raise {0} {1} or only the unit: write ({0} {1})^... or {0}*(1 {1})^...",
                number, unit));
    }

    void read_word() {
        const std::size_t from = at_;
        const std::string_view word = word_at(at_);
        at_ += word.size();
        std::size_t next = at_;
        while (next < text_.size() && is_blank(text_[next])) ++next;
        const bool is_called = next < text_.size() && text_[next] == '(';
        const Function* function = function_named(word);
        const auto variable = std::find(variables_.begin(), variables_.end(), word);
        if (is_called && function != nullptr) {
            write(word, from);
            write("(", next);
            open_bracket(next, true);
            at_ = next + 1;
        } else if (is_called && (variable != variables_.end() || word == "pi")) {
            refuse(from,
                   fmt::format("\"{0}\" is not a function; to multiply write {0}*(...)", word));
        } else if (is_called) {
            refuse(from, fmt::format("unknown function \"{}\"{}", word,
                                     did_you_mean(word, function_names())));
        } else if (variable != variables_.end()) {
            is_used_[static_cast<std::size_t>(variable - variables_.begin())] = true;
            write(word, from);
        } else if (word == "pi") {
            write(word, from);
        } else if (function != nullptr) {
            refuse(from,
                   fmt::format("the function {} needs brackets: {}", word, function->arguments));
        } else {
            std::vector<std::string> known = variables_;
            known.emplace_back("pi");
            refuse(from, fmt::format("unknown name \"{}\"{}", word, did_you_mean(word, known)));
        }
    }

    void read_sign() {
        const std::string_view rest = text_.substr(at_);
        for (const char* two : {"<=", ">=", "==", "!=", "&&", "||"}) {
            if (rest.starts_with(two)) {
                note_comparison(two);
                write(two, at_);
                at_ += 2;
                return;
            }
        }
        const char sign = rest[0];
        if (sign == '(') {
            open_bracket(at_, false);
        } else if (sign == ')') {
            if (bracket_.empty()) refuse(at_, "this bracket was never opened");
            bracket_.pop_back();
        } else if (sign == ',') {
            if (bracket_.empty() || !bracket_.back().of_function) {
                refuse(at_,
                       "a comma can only separate the arguments of a function; the decimal sign is "
                       "a point");
            }
        } else if (sign == '=') {
            refuse(at_, "a single = has no meaning here; to compare write ==");
        } else if (std::string_view("+-*/^<>?:").find(sign) == std::string_view::npos) {
            refuse(at_, fmt::format("\"{}\" does not belong in an expression", sign));
        }
        note_comparison(rest.substr(0, 1));
        write(sign == '^' ? kPower : std::string_view(&sign, 1), at_);
        ++at_;
        if (sign == '+' || sign == '-') refuse_sign_of_nothing(sign);
    }

    // 1 < x < 2 would ask whether 0 or 1, which 1 < x is, is less than 2.
    void note_comparison(std::string_view sign) {
        bool& compares = bracket_.empty() ? compares_ : bracket_.back().compares;
        if (sign == "&&" || sign == "||" || sign == "?" || sign == ":" || sign == ",") {
            compares = false;
        } else if (sign.find_first_of("<>=!") == 0) {
            if (compares) {
                refuse(at_,
                       "only two values can be compared: write a < b && b < c, or use brackets");
            }
            compares = true;
        }
    }

    void open_bracket(std::size_t at, bool of_function) {
        bracket_.push_back({at, of_function});
        if (bracket_.size() > kDeepest) refuse(at, "brackets are nested too deeply");
    }

    // muparser knows no words for it where the sign is that of a number.
    void refuse_sign_of_nothing(char sign) const {
        std::size_t next = at_;
        while (next < text_.size() && is_blank(text_[next])) ++next;
        if (next == text_.size()) refuse(next, "the expression ends too early");
        if (std::string_view(",?:").find(text_[next]) == std::string_view::npos) return;
        refuse(at_ - 1, fmt::format("the operator \"{}\" lacks an operand", sign));
    }

    static std::vector<std::string> function_names() {
        std::vector<std::string> names;
        for (const Function& one : kFunctions) names.emplace_back(one.name);
        return names;
    }

    std::string_view text_;
    const std::vector<std::string>& variables_;
    std::size_t at_ = 0;
    std::string written_;
    std::vector<std::size_t> origin_;
    std::vector<bool> is_used_;
    std::vector<Bracket> bracket_;
    bool compares_ = false;  // as Bracket::compares, outside of all
};

// `at`: the sign of the user's text where it stands; 0 at the end.
std::string sentence_for(const mu::ParserError& error, char at) {
    const std::string& token = error.GetToken();
    const Function* function = function_named(token);
    switch (error.GetCode()) {
        case mu::ecUNEXPECTED_EOF:
            return "the expression ends too early";
        case mu::ecUNEXPECTED_OPERATOR:
            return fmt::format("the operator \"{}\" lacks an operand", token);
        case mu::ecUNEXPECTED_VAL:
        case mu::ecUNEXPECTED_VAR:
        case mu::ecUNEXPECTED_FUN:
            return "an operator is missing before this";
        case mu::ecUNEXPECTED_PARENS:
            // Numbers are written in brackets: an opening one is often none of the user's.
            return at == ')' ? "a bracket does not belong here"
                             : "an operator is missing before this";
        case mu::ecUNEXPECTED_ARG_SEP:
            return "a comma does not belong here";
        case mu::ecMISPLACED_COLON:
            return "this : has no ? before it";
        case mu::ecMISSING_ELSE_CLAUSE:
            return "a ? needs a : after it: CONDITION ? A : B";
        case mu::ecUNEXPECTED_CONDITIONAL:
            return "this ? has no condition before it";
        case mu::ecTOO_MANY_PARAMS:
        case mu::ecTOO_FEW_PARAMS:
            return fmt::format("too {} arguments{}",
                               error.GetCode() == mu::ecTOO_FEW_PARAMS ? "few" : "many",
                               function == nullptr ? "" : std::string(": ") + function->arguments);
        default:
            return "cannot be parsed: " + error.GetMsg();
    }
}

}  // namespace

struct Formula::Compiled {
    std::string text;
    std::vector<std::string> variables;
    std::vector<bool> is_used;
    std::vector<double> value;  // what the parser's variables point to
    mu::Parser parser;
    std::mutex computing;  // the parser keeps its stack of numbers in itself
};

Formula::Formula(const std::string& text, const std::vector<std::string>& variables)
    : compiled_(std::make_shared<Compiled>()) {
    Reader reader(text, variables);
    reader.read();
    compiled_->text = text;
    compiled_->variables = variables;
    compiled_->is_used = reader.is_used();
    compiled_->value.assign(variables.size(), 1.0);
    static const mu::Parser prototype = make_parser();
    compiled_->parser = prototype;
    try {
        for (std::size_t n = 0; n < variables.size(); ++n) {
            if (compiled_->is_used[n]) {
                compiled_->parser.DefineVar(variables[n], &compiled_->value[n]);
            }
        }
        compiled_->parser.SetExpr(reader.written());
        compiled_->parser.Eval();  // compiles
    } catch (const mu::ParserError& error) {
        const std::size_t at = reader.origin(error.GetPos());
        throw TextError(at, sentence_for(error, at < text.size() ? text[at] : '\0'));
    }
}

double Formula::evaluate(std::span<const double> values) const {
    const std::lock_guard lock(compiled_->computing);
    if (values.size() != compiled_->value.size()) {
        throw TextError(0, fmt::format("\"{}\" needs {} values, not {}", compiled_->text,
                                       compiled_->value.size(), values.size()));
    }
    std::copy(values.begin(), values.end(), compiled_->value.begin());
    const double result = compiled_->parser.Eval();
    if (!std::isfinite(result)) {
        throw TextError(0, "the expression does not give a finite number");
    }
    return result + 0.0;
}

const std::string& Formula::text() const { return compiled_->text; }
const std::vector<std::string>& Formula::variables() const { return compiled_->variables; }

std::vector<std::string> Formula::used() const {
    std::vector<std::string> names;
    for (std::size_t n = 0; n < compiled_->variables.size(); ++n) {
        if (compiled_->is_used[n]) names.push_back(compiled_->variables[n]);
    }
    return names;
}

double evaluate_text(const std::string& text, const std::map<std::string, double>& variables) {
    std::vector<std::string> names;
    std::vector<double> values;
    for (const auto& [name, value] : variables) {
        names.push_back(name);
        values.push_back(value);
    }
    return Formula(text, names).evaluate(values);
}

std::vector<FormulaFunction> formula_functions() {
    std::vector<FormulaFunction> functions;
    for (const Function& f : kFunctions) functions.push_back({f.arguments, f.help});
    return functions;
}

bool is_reserved_name(const std::string& name) {
    if (name == "pi" || function_named(name) != nullptr) return true;
    const auto unit = leading_unit(name);
    return unit && unit->size == name.size();
}

}  // namespace swage
