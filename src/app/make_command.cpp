// SPDX-License-Identifier: GPL-3.0-or-later
#include <map>

#include "app/command.h"
#include "app/help_format.h"
#include "base/error.h"
#include "base/log.h"
#include "base/text_error.h"
#include "base/units.h"
#include "geometry/files_beside.h"
#include "geometry/make_shape.h"
#include "geometry/mesh_check.h"
#include "geometry/mesh_write.h"
#include "render/png.h"

namespace swage {

namespace fs = std::filesystem;

namespace {

struct MakeArguments {
    std::string out;
    std::map<std::string, std::string> value;  // of the chosen shape's parameters, as given
};

// "" would pass for what nobody gave.
const CLI::Validator kSomething(
    [](const std::string& text) { return text.empty() ? "\"\" is no value" : std::string(); }, "");

Quantity quantity_of(ParameterKind kind) {
    switch (kind) {
        case ParameterKind::length:
            return Quantity::length;
        case ParameterKind::angle:
            return Quantity::angle;
        default:
            return Quantity::number;
    }
}

std::string option_name(const std::string& parameter) {
    std::string name = "--" + parameter;
    for (char& c : name) c = c == '_' ? '-' : c;
    return name;
}

std::string shown(double value, ParameterKind kind) {
    return quantity_text(value, quantity_of(kind));
}

void write_shape(const fs::path& file, MadeShape shape) {
    FilesBeside picture;
    if (shape.texture && !shape.mesh.material.empty()) {
        const fs::path folder = fs::absolute(file).parent_path();
        shape.mesh.material[0].texture =
            folder / picture.add(folder, plain_name(file.stem().string(), "texture") + ".png",
                                 encode_png({shape.texture->width, shape.texture->height,
                                             shape.texture->rgb}));
    }
    file.extension() == ".obj" ? write_obj(file, shape.mesh) : write_ply(file, shape.mesh);
    picture.stay();
}

int make(const ShapeInfo& info, const MakeArguments& given) {
    std::map<std::string, double> parameters;
    for (const ShapeParameter& parameter : info.parameters) {
        const auto at = given.value.find(parameter.name);
        if (at == given.value.end() || at->second.empty()) continue;
        try {
            parameters[parameter.name] = parse_quantity(at->second, quantity_of(parameter.kind));
        } catch (const TextError& error) {
            fail(ExitCode::command_line, "{} {}: {}", option_name(parameter.name), at->second,
                 error.what());
        }
    }
    const fs::path file = given.out.empty() ? fs::path(info.name + ".obj") : fs::path(given.out);
    if (file.extension() != ".obj" && file.extension() != ".ply") {
        fail(ExitCode::command_line, "{}: only .obj and .ply can be written", file.string());
    }
    const MadeShape shape = make_shape(info.name, parameters);
    write_shape(file, shape);
    log_info("{}: {}", file.string(), summary_line(check_mesh(shape.mesh)));
    return 0;
}

}  // namespace

void add_make_command(CLI::App& app, Action& chosen) {
    static MakeArguments given;
    CLI::App* command = app.add_subcommand("make", "Make one of swage's own meshes");
    command->require_subcommand(1);
    const auto format = std::make_shared<HelpFormat>();
    format->label("COMMAND", "SHAPE");
    format->label("Commands", "Shapes");
    command->formatter(format);
    command->footer(
        "\nExamples:\n"
        "  swage make bar --out /tmp/bar.obj\n"
        "  swage make rod --length \"30 cm\" --diameter \"8 mm\" --out /tmp/rod.obj\n"
        "  swage make gear --help\n");
    for (const ShapeInfo& info : shape_catalogue()) {
        CLI::App* shape = add_command(*command, info.name, info.help,
                                      fmt::format("  swage make {0} --out /tmp/{0}.obj\n"
                                                  "  swage make {0} --out /tmp/{0}.ply\n",
                                                  info.name),
                                      chosen, [&info] { return make(info, given); });
        shape->add_option("-o,--out", given.out, "OBJ or PLY file to write (default: SHAPE.obj)")
            ->type_name("FILE");
        for (const ShapeParameter& parameter : info.parameters) {
            shape
                ->add_option(option_name(parameter.name), given.value[parameter.name],
                             fmt::format("{} ({} to {}; default {})", parameter.help,
                                         shown(parameter.low, parameter.kind),
                                         shown(parameter.high, parameter.kind),
                                         shown(parameter.value, parameter.kind)))
                ->check(kSomething)
                ->type_name(parameter.kind == ParameterKind::length  ? "LENGTH"
                            : parameter.kind == ParameterKind::angle ? "ANGLE"
                            : parameter.kind == ParameterKind::count ? "N"
                                                                     : "NUMBER");
        }
    }
}

}  // namespace swage
