// SPDX-License-Identifier: GPL-3.0-or-later
// STL, glTF, GLB, DAE, 3DS and 3MF through assimp; the one file that sees it. Runs only in
// the child process: assimp 5.2 crashes on some broken files.
#include <assimp/GltfMaterial.h>
#include <assimp/material.h>
#include <assimp/scene.h>

#include <assimp/importerdesc.h>
#include <Eigen/Geometry>
#include <algorithm>
#include <assimp/DefaultLogger.hpp>
#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <assimp/LogStream.hpp>
#include <cstring>
#include <limits>
#include <map>
#include <new>

#include "base/error.h"
#include "base/portable_math.h"
#include "base/srgb.h"
#include "geometry/box.h"
#include "geometry/mesh_check.h"
#include "geometry/mesh_read_child.h"
#include "geometry/text_scan.h"

namespace swage {

namespace {

class MemoryStream : public Assimp::IOStream {
  public:
    explicit MemoryStream(std::string bytes) : bytes_(std::move(bytes)) {}
    std::size_t Read(void* to, std::size_t size, std::size_t count) override {
        if (size == 0) return 0;
        const std::size_t whole = std::min(count, (bytes_.size() - at_) / size);
        std::memcpy(to, bytes_.data() + at_, whole * size);
        at_ += whole * size;
        return whole;
    }
    std::size_t Write(const void*, std::size_t, std::size_t) override { return 0; }
    aiReturn Seek(std::size_t offset, aiOrigin origin) override {
        const std::size_t base = origin == aiOrigin_SET   ? 0
                                 : origin == aiOrigin_CUR ? at_
                                                          : bytes_.size();
        const std::size_t to = origin == aiOrigin_END ? base - offset : base + offset;
        if (to > bytes_.size()) return aiReturn_FAILURE;
        at_ = to;
        return aiReturn_SUCCESS;
    }
    std::size_t Tell() const override { return at_; }
    std::size_t FileSize() const override { return bytes_.size(); }
    void Flush() override {}

  private:
    std::string bytes_;
    std::size_t at_ = 0;
};

// Hands out regular files only, so that a mesh that names a pipe or a device cannot block.
class FileSystem : public Assimp::IOSystem {
  public:
    explicit FileSystem(const MeshSource& source) : source_(source) {}
    bool Exists(const char* file) const override {
        std::error_code ignored;
        return std::filesystem::is_regular_file(file, ignored);
    }
    char getOsSeparator() const override { return '/'; }
    Assimp::IOStream* Open(const char* file, const char* mode) override {
        if (std::strchr(mode, 'w') != nullptr || std::strchr(mode, 'a') != nullptr) return nullptr;
        if (source_.file == file) return new MemoryStream(source_.bytes);
        auto bytes = file_contents(file, source_.file_bytes);
        return bytes ? new MemoryStream(std::move(*bytes)) : nullptr;
    }
    void Close(Assimp::IOStream* stream) override { delete stream; }

  private:
    const MeshSource& source_;
};

// What assimp says while it reads: where it drops faces, it says so here only.
class Listener : public Assimp::LogStream {
  public:
    explicit Listener(std::string& dropped) : dropped_(dropped) {}
    void write(const char* message) override {
        const std::string_view text = trimmed_line(message);
        for (const char* sign : {"out-of-range", "out of range", "ropped"})
            if (text.find(sign) != std::string_view::npos) dropped_ = text;
    }

  private:
    // Without "Warn,  T0: " and the end of the line.
    static std::string_view trimmed_line(std::string_view text) {
        if (const std::size_t at = text.find(": "); at < 16) text.remove_prefix(at + 2);
        return trimmed(text.substr(0, text.find('\n')));
    }
    std::string& dropped_;
};

// Takes out every reader but those for the extension: a file never reaches another format's.
void keep_only(Assimp::Importer& importer, const std::string& extension) {
    for (std::size_t i = importer.GetImporterCount(); i-- > 0;) {
        const aiImporterDesc* info = importer.GetImporterInfo(i);
        std::string_view words = info == nullptr ? "" : info->mFileExtensions;
        bool fits = false;
        for (std::string_view word; !(word = next_word(words)).empty();)
            fits = fits || word == extension;
        if (!fits) importer.UnregisterLoader(importer.GetImporter(i));
    }
}

constexpr double kSingle = 0.5 * std::numeric_limits<float>::epsilon();
constexpr double kRounded = 1e-5;  // of a mesh, by what its places may be rounded untold

bool is_rounded_from(const std::vector<Vec3>& given, const std::vector<Vec3>& read) {
    if (given.empty() || given.size() != read.size()) return false;
    for (std::size_t v = 0; v < read.size(); ++v) {
        if ((given[v] - read[v]).norm() > 4 * kSingle * given[v].norm()) return false;
    }
    return true;
}

class SceneReader {
  public:
    SceneReader(MeshSource& source, const aiScene& scene) : source_(source), scene_(scene) {}

    // What single precision does to a place farthest from its origin [units].
    double rounds_by() const { return kSingle * farthest_; }

    RawMesh read() {
        if (scene_.mRootNode == nullptr) fail(ExitCode::mesh, "the file contains no scene");
        visit(*scene_.mRootNode, aiMatrix4x4());
        if (polygons_.size() == 0) fail(ExitCode::mesh, "the file contains no faces");
        read_materials();
        mesh_.at_vertices = 1;
        if (mesh_.part_name.size() == 1 && !is_named_) {
            mesh_.part_name.clear();
            std::fill(polygons_.part.begin(), polygons_.part.end(), -1);
        }
        if (!mesh_.color.empty())
            mesh_.color.resize(mesh_.position.size(), Eigen::Vector3f::Ones());
        const auto say = [&](bool is_so, const char* what) {
            if (is_so) source_.finding.emplace_back(what);
        };
        say(lines_and_points_ > 0, "lines and points were left out");
        say(has_bones_ || scene_.mNumAnimations > 0,
            "bones and animations are ignored: the mesh has its modelled pose");
        say(has_shapes_, "morph targets were left out");
        say(more_uv_,
            "of several sets of texture coordinates only the one used by the colour image was "
            "read");
        say(more_color_, "only the first set of vertex colours was read");
        add_polygons(polygons_, mesh_);
        return std::move(mesh_);
    }

  private:
    void visit(const aiNode& node, const aiMatrix4x4& world_from_parent) {
        const aiMatrix4x4 world_from_node = world_from_parent * node.mTransformation;
        for (unsigned i = 0; i < node.mNumMeshes; ++i) {
            if (node.mMeshes[i] >= scene_.mNumMeshes)
                fail(ExitCode::mesh, "node '{}' names mesh {} of {}", node.mName.C_Str(),
                     node.mMeshes[i], scene_.mNumMeshes);
            add_mesh(*scene_.mMeshes[node.mMeshes[i]], node, world_from_node);
        }
        for (unsigned i = 0; i < node.mNumChildren; ++i) visit(*node.mChildren[i], world_from_node);
    }

    // Empty where the file gives none and assimp has made one up.
    static std::string given_name(std::string name) {
        const bool counted = name.starts_with("nodes[") || name.starts_with("meshes[");
        return counted || name.starts_with("$ColladaAutoName$") ? std::string() : name;
    }

    // As the object is called in the program that wrote the file: there a node of glTF and DAE.
    std::string part_name_of(const aiMesh& mesh, const aiNode& node) const {
        std::string name = mesh.mName.C_Str();
        switch (source_.format) {
            case MeshFormat::stl:
                return name;
            case MeshFormat::gltf:
            case MeshFormat::glb:
            case MeshFormat::dae:
                if (std::string own = given_name(node.mName.C_Str()); !own.empty()) return own;
                // assimp counts the pieces of a glTF mesh, one a material.
                if (is_gltf() && node.mNumMeshes > 1) name = name.substr(0, name.rfind('-'));
                return given_name(name);
            default:
                return name.empty() ? node.mName.C_Str() : name;
        }
    }

    int part_of(const aiMesh& mesh, const aiNode& node) {
        std::string name = part_name_of(mesh, node);
        is_named_ = is_named_ || !name.empty();
        if (name.empty()) name = "part";
        // One node's meshes of one name differ in material only: one part.
        const auto [at, is_new] =
            part_id_.emplace(std::make_pair(&node, name), static_cast<int>(mesh_.part_name.size()));
        if (is_new) {
            const int uses = ++name_uses_[name];
            mesh_.part_name.push_back(uses == 1 ? name : fmt::format("{}.{}", name, uses));
        }
        return at->second;
    }

    bool is_gltf() const {
        return source_.format == MeshFormat::gltf || source_.format == MeshFormat::glb;
    }

    // glTF's colours are light itself. A 3MF file's are sRGB, says its specification; a DAE, 3DS or
    // STL file's are what a screen showed to who chose them.
    Vec3 light_of(double red, double green, double blue) const {
        Vec3 color = Vec3(red, green, blue).cwiseMax(0.0).cwiseMin(1.0);
        if (is_gltf()) return color;
        for (double& c : color) c = linear_from_srgb(c);
        return color;
    }

    // Where on a glTF material's image (KHR_texture_transform) texture coordinates are, which count
    // from below here and from above there. assimp turns about the image's middle, the other way,
    // and has moved the rest to suit.
    Eigen::Affine2d image_from_uv(unsigned material) const {
        Eigen::Affine2d on_image = Eigen::Affine2d::Identity();
        aiUVTransform by;
        if (!is_gltf() || material >= scene_.mNumMaterials ||
            scene_.mMaterials[material]->Get(AI_MATKEY_UVTRANSFORM(aiTextureType_BASE_COLOR, 0),
                                             by) != AI_SUCCESS)
            return on_image;
        const double c = portable::cos(-by.mRotation), s = portable::sin(-by.mRotation);
        const Vec2 scale(by.mScaling.x, by.mScaling.y);
        on_image.linear() << scale.x() * c, scale.y() * s, -scale.x() * s, scale.y() * c;
        on_image.translation() << by.mTranslation.x - 0.5 * scale.x() * (1 - c + s),
            1 - scale.y() + 0.5 * scale.y() * (s + c - 1) - by.mTranslation.y;
        const Eigen::Affine2d from_above(Eigen::Translation2d(0, 1) * Eigen::Scaling(1.0, -1.0));
        return from_above * on_image * from_above;
    }

    // The set of texture coordinates that its material's image lies by.
    unsigned uv_set_of(const aiMesh& mesh) const {
        int set = 0;
        if (mesh.mMaterialIndex < scene_.mNumMaterials)
            for (const aiTextureType type : kColorImages)
                if (scene_.mMaterials[mesh.mMaterialIndex]->Get(AI_MATKEY_UVWSRC(type, 0), set) ==
                    AI_SUCCESS)
                    break;
        return set > 0 && mesh.HasTextureCoords(static_cast<unsigned>(set))
                   ? static_cast<unsigned>(set)
                   : 0;
    }

    void add_mesh(const aiMesh& mesh, const aiNode& node, const aiMatrix4x4& m) {
        if (mesh.mNumFaces == 0 || mesh.mVertices == nullptr) return;
        // Points and lines alone are no part.
        bool has_surface = false;
        for (unsigned f = 0; f < mesh.mNumFaces && !has_surface; ++f)
            has_surface = mesh.mFaces[f].mNumIndices >= 3;
        if (!has_surface) {
            lines_and_points_ += mesh.mNumFaces;
            return;
        }
        Eigen::Matrix4d world_from_mesh;
        for (int r = 0; r < 4; ++r)
            for (int c = 0; c < 4; ++c) world_from_mesh(r, c) = m[r][c];
        const Mat3 linear = world_from_mesh.topLeftCorner<3, 3>();
        const bool mirrored = linear.determinant() < 0;
        // Cofactors carry normals also through a singular matrix.
        Mat3 cofactor;
        for (int k = 0; k < 3; ++k)
            cofactor.col(k) = linear.col((k + 1) % 3).cross(linear.col((k + 2) % 3));
        if (mirrored) cofactor = -cofactor;

        const int base = static_cast<int>(mesh_.position.size());
        if (mesh_.position.size() + mesh.mNumVertices > 0x7fffffff)
            fail(ExitCode::mesh, "more vertices than can be handled");
        // An STL file's normals belong to facets and say nothing about shading.
        const bool has_normal = mesh.HasNormals() && source_.format != MeshFormat::stl;
        const unsigned uv_set = uv_set_of(mesh);
        const bool has_uv = mesh.HasTextureCoords(uv_set);
        const Eigen::Affine2d on_image = image_from_uv(mesh.mMaterialIndex);
        if (mesh.HasVertexColors(0) && mesh_.color.empty())
            mesh_.color.resize(base, Eigen::Vector3f::Ones());
        mesh_.uv.resize(base, Vec2::Zero());
        mesh_.normal.resize(base, Eigen::Vector3f::Zero());
        for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
            const aiVector3D& p = mesh.mVertices[v];
            const Vec3 own = linear * Vec3(p.x, p.y, p.z);
            farthest_ = std::max(farthest_, own.cwiseAbs().maxCoeff());
            mesh_.position.push_back(own + world_from_mesh.topRightCorner<3, 1>());
            if (has_normal) {
                const aiVector3D& n = mesh.mNormals[v];
                mesh_.normal.push_back(
                    (cofactor * Vec3(n.x, n.y, n.z)).stableNormalized().cast<float>());
            }
            if (has_uv)
                mesh_.uv.push_back(on_image * Vec2(mesh.mTextureCoords[uv_set][v].x,
                                                   mesh.mTextureCoords[uv_set][v].y));
            if (mesh.HasVertexColors(0)) {
                const aiColor4D& c = mesh.mColors[0][v];
                mesh_.color.push_back(light_of(c.r, c.g, c.b).cast<float>());
            }
        }
        if (!mesh_.color.empty())
            mesh_.color.resize(mesh_.position.size(), Eigen::Vector3f::Ones());
        const int part = part_of(mesh, node);
        for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
            const aiFace& face = mesh.mFaces[f];
            if (face.mNumIndices < 3) {
                ++lines_and_points_;
                continue;
            }
            for (unsigned k = 0; k < face.mNumIndices; ++k) {
                const unsigned i = face.mIndices[mirrored ? face.mNumIndices - 1 - k : k];
                if (i >= mesh.mNumVertices)
                    fail(ExitCode::mesh, "face {} of '{}': vertex {} of {} does not exist", f,
                         mesh.mName.C_Str(), i, mesh.mNumVertices);
                const int vertex = base + static_cast<int>(i);
                polygons_.add_corner(vertex, has_uv ? vertex : -1, has_normal ? vertex : -1);
            }
            polygons_.end_polygon(static_cast<int>(mesh.mMaterialIndex), part, 0);
        }
        has_bones_ = has_bones_ || mesh.HasBones();
        has_shapes_ = has_shapes_ || mesh.mNumAnimMeshes > 0;
        more_uv_ = more_uv_ || mesh.HasTextureCoords(1);
        more_color_ = more_color_ || mesh.HasVertexColors(1);
    }

    void read_materials() {
        std::vector<int> number(scene_.mNumMaterials, -1);
        bool all_default = true;
        for (int& id : polygons_.material) {
            if (id < 0 || id >= static_cast<int>(number.size()))
                fail(ExitCode::mesh, "material {} of {} does not exist", id, number.size());
            const int file_id = id;
            if (number[file_id] < 0) {
                number[file_id] = static_cast<int>(mesh_.material.size());
                const aiMaterial& material = *scene_.mMaterials[file_id];
                all_default = all_default && std::strcmp(material.GetName().C_Str(),
                                                         AI_DEFAULT_MATERIAL_NAME) == 0;
                mesh_.material.push_back(material_from(material));
            }
            id = number[file_id];
        }
        if (all_default) {  // assimp's own filler
            mesh_.material.clear();
            std::fill(polygons_.material.begin(), polygons_.material.end(), -1);
        }
    }

    RawMaterial material_from(const aiMaterial& from) {
        RawMaterial to;
        to.name = from.GetName().C_Str();
        aiColor4D color;
        if (from.Get(AI_MATKEY_BASE_COLOR, color) == AI_SUCCESS ||
            from.Get(AI_MATKEY_COLOR_DIFFUSE, color) == AI_SUCCESS)
            to.color = light_of(color.r, color.g, color.b);
        const bool has_surface_map =
            from.GetTextureCount(aiTextureType_METALNESS) > 0 ||
            from.GetTextureCount(aiTextureType_DIFFUSE_ROUGHNESS) > 0 ||
            from.GetTexture(AI_MATKEY_GLTF_PBRMETALLICROUGHNESS_METALLICROUGHNESS_TEXTURE,
                            &path_) == AI_SUCCESS;
        float value = 0;
        if (has_surface_map) {  // the factors mean little without the image they multiply
            source_.tell_of_look(fmt::format(
                "material '{}': its image of metalness and roughness was left out", to.name));
        } else {
            if (from.Get(AI_MATKEY_METALLIC_FACTOR, value) == AI_SUCCESS) to.metallic = value;
            if (from.Get(AI_MATKEY_ROUGHNESS_FACTOR, value) == AI_SUCCESS) to.roughness = value;
        }
        if (from.GetTextureCount(aiTextureType_NORMALS) > 0)
            source_.tell_of_look(
                fmt::format("material '{}': its normal map was left out", to.name));
        for (const aiTextureType type : kColorImages) {
            if (from.GetTextureCount(type) == 0) continue;
            if (from.GetTexture(type, 0, &path_) != AI_SUCCESS) continue;
            aiUVTransform transform;
            if (!is_gltf() && from.Get(AI_MATKEY_UVTRANSFORM(type, 0), transform) == AI_SUCCESS &&
                (transform.mScaling != aiVector2D(1, 1) ||
                 transform.mTranslation != aiVector2D(0, 0) || transform.mRotation != 0))
                source_.tell_of_look(fmt::format(
                    "material '{}': the offset and scale of its texture were left out", to.name));
            // An image stands in the place of a colour there, and assimp makes one up.
            if (source_.format == MeshFormat::dae) to.color = Vec3::Ones();
            take_texture(to);
            break;
        }
        return to;
    }

    void take_texture(RawMaterial& to) {
        const aiTexture* inside = scene_.GetEmbeddedTexture(path_.C_Str());
        if (inside == nullptr) {
            to.texture = path_.C_Str();
        } else if (inside->mHeight == 0 && inside->pcData != nullptr) {
            to.texture_bytes.assign(reinterpret_cast<const char*>(inside->pcData), inside->mWidth);
        } else {
            source_.tell_of_look(
                fmt::format("material '{}': an uncompressed image was left out", to.name));
        }
    }

    static constexpr aiTextureType kColorImages[] = {aiTextureType_BASE_COLOR,
                                                     aiTextureType_DIFFUSE};

    MeshSource& source_;
    const aiScene& scene_;
    RawMesh mesh_;
    PolygonList polygons_;
    std::map<std::pair<const aiNode*, std::string>, int> part_id_;
    std::map<std::string, int> name_uses_;
    bool is_named_ = false;
    double farthest_ = 0;
    aiString path_;
    std::size_t lines_and_points_ = 0;
    bool has_bones_ = false, has_shapes_ = false, more_uv_ = false, more_color_ = false;
};

}  // namespace

RawMesh read_by_assimp(MeshSource& source) {
    std::vector<Vec3> corner;
    if (source.format == MeshFormat::stl) corner = patch_stl(source);
    if (source.format == MeshFormat::gltf || source.format == MeshFormat::glb) patch_gltf(source);
    const double unit = source.format == MeshFormat::tmf ? patch_3mf(source) : 1;
    const std::string extension = kMeshEnding[std::size_t(source.format)];
    std::string dropped;
    Assimp::DefaultLogger::create("", Assimp::Logger::NORMAL, 0);
    Assimp::DefaultLogger::get()->attachStream(new Listener(dropped),
                                               Assimp::Logger::Warn | Assimp::Logger::Err);
    Assimp::Importer importer;
    keep_only(importer, extension);
    importer.SetIOHandler(new FileSystem(source));
    const aiScene* scene = importer.ReadFile(source.file.string(), 0);
    if (scene == nullptr) {
        const std::string why = importer.GetErrorString();
        if (why.find("bad_alloc") != std::string::npos) throw std::bad_alloc();
        fail(ExitCode::mesh, "not a readable .{} file ({})", extension, why);
    }
    if (!dropped.empty()) fail(ExitCode::mesh, "the file is damaged ({})", dropped);
    SceneReader reader(source, *scene);
    RawMesh mesh = reader.read();
    if (reader.rounds_by() > kRounded * box_of(mesh.position).size().norm()) {
        if (is_rounded_from(corner, mesh.position)) {
            mesh.position = std::move(corner);
        } else {
            source.finding.push_back(fmt::format(
                "its places are rounded by up to {}, as they are read in single precision: move it "
                "nearer to its origin in the program that wrote it",
                length_text(unit * reader.rounds_by())));
        }
    }
    for (Vec3& p : mesh.position) p *= unit;
    return mesh;
}

}  // namespace swage
