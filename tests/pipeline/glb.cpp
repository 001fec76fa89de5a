// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/pipeline/glb.h"

#include <algorithm>
#include <cstring>

namespace swage::test {

namespace {

std::uint32_t word(const std::string& bytes, std::size_t at) {
    std::uint32_t value;
    REQUIRE(at + sizeof value <= bytes.size());
    std::memcpy(&value, bytes.data() + at, sizeof value);
    return value;
}

}  // namespace

Glb::Glb(const std::string& bytes) {
    REQUIRE(bytes.substr(0, 4) == "glTF");
    CHECK(word(bytes, 4) == 2);
    CHECK(word(bytes, 8) == bytes.size());
    const std::size_t text = word(bytes, 12);
    CHECK(text % 4 == 0);
    REQUIRE(bytes.substr(16, 4) == "JSON");
    document = parse_json(bytes.substr(20, text));
    const std::size_t at = 20 + text;
    REQUIRE(bytes.substr(at + 4, 4) == std::string("BIN\0", 4));
    binary_ = bytes.substr(at + 8);
    CHECK(word(bytes, at) == binary_.size());
    CHECK(document.at("buffers").at(0).at("byteLength") == binary_.size());
    CHECK(document.at("asset").at("version") == "2.0");
    std::size_t end = 0;
    for (const Json& view : document.at("bufferViews")) {
        const auto offset = view.at("byteOffset").get<std::size_t>();
        CHECK(offset % 4 == 0);
        CHECK(offset >= end);
        end = offset + view.at("byteLength").get<std::size_t>();
        CHECK(end <= binary_.size());
    }
    for (std::size_t a = 0; a < document.at("accessors").size(); ++a) {
        const Json& accessor = document["accessors"][a];
        if (!accessor.contains("min")) continue;
        const std::vector<float> all = numbers(static_cast<int>(a));
        const std::size_t width = accessor.at("min").size();
        for (std::size_t c = 0; c < width; ++c) {
            float low = all.at(c), high = low;
            for (std::size_t n = c; n < all.size(); n += width) {
                low = std::min(low, all[n]), high = std::max(high, all[n]);
            }
            CHECK(accessor["min"][c].get<float>() == low);
            CHECK(accessor["max"][c].get<float>() == high);
        }
    }
    parent_.assign(document.at("nodes").size(), -1);
    for (std::size_t n = 0; n < parent_.size(); ++n) {
        const Json& node = document["nodes"][n];
        for (const Json& child : node.value("children", Json::array())) {
            parent_.at(child.get<std::size_t>()) = static_cast<int>(n);
        }
    }
}

std::string Glb::view(int number) const {
    const Json& view = document.at("bufferViews").at(std::size_t(number));
    return binary_.substr(view.at("byteOffset"), view.at("byteLength"));
}

std::vector<float> Glb::numbers(int accessor) const {
    const Json& of = document.at("accessors").at(std::size_t(accessor));
    REQUIRE(of.at("componentType") == 5126);
    const std::string type = of.at("type");
    const std::size_t width = type == "SCALAR" ? 1 : std::size_t(type.back() - '0');
    const std::string bytes = view(of.at("bufferView"));
    std::vector<float> all(of.at("count").get<std::size_t>() * width);
    const std::size_t offset = of.at("byteOffset");
    REQUIRE(offset + all.size() * sizeof(float) <= bytes.size());
    std::memcpy(all.data(), bytes.data() + offset, all.size() * sizeof(float));
    return all;
}

std::vector<std::uint32_t> Glb::indices(int accessor) const {
    const Json& of = document.at("accessors").at(std::size_t(accessor));
    REQUIRE(of.at("componentType") == 5125);
    const std::string bytes = view(of.at("bufferView"));
    std::vector<std::uint32_t> all(of.at("count").get<std::size_t>());
    REQUIRE(all.size() * sizeof(std::uint32_t) == bytes.size());
    std::memcpy(all.data(), bytes.data(), bytes.size());
    return all;
}

int Glb::node(const std::string& name) const {
    int found = -1;
    for (std::size_t n = 0; n < parent_.size(); ++n) {
        if (document.at("nodes")[n].at("name") != name) continue;
        CHECK(found == -1);
        found = static_cast<int>(n);
    }
    INFO(name);
    REQUIRE(found >= 0);
    return found;
}

std::vector<float> Glb::value(int node, const std::string& path, double time) const {
    const Json& of = document.at("nodes").at(std::size_t(node));
    std::vector<float> still;
    if (path == "weights" && of.contains("mesh")) {
        still = document.at("meshes")
                    .at(of.at("mesh").get<std::size_t>())
                    .value("weights", std::vector<float>());
    } else if (of.contains(path)) {
        still = of.at(path).get<std::vector<float>>();
    }
    for (const Json& animation : document.value("animations", Json::array())) {
        for (const Json& channel : animation.at("channels")) {
            if (channel.at("target").at("node") != node) continue;
            if (channel.at("target").at("path") != path) continue;
            const Json& sampler =
                animation.at("samplers").at(channel.at("sampler").get<std::size_t>());
            const std::vector<float> times = numbers(sampler.at("input")),
                                     values = numbers(sampler.at("output"));
            const std::size_t width = values.size() / times.size();
            REQUIRE(width * times.size() == values.size());
            CHECK(std::is_sorted(times.begin(), times.end(), std::less_equal<float>()));
            for (std::size_t n = 0; path == "rotation" && n < values.size(); n += 4) {
                CHECK(std::abs(Eigen::Vector4f(&values[n]).norm() - 1) < 1e-5f);
            }
            std::size_t next = 0;
            while (next < times.size() && times[next] <= time + 1e-6) ++next;
            const std::size_t before = next == 0 ? 0 : next - 1;
            next = std::min(next, times.size() - 1);
            double share = 0;
            if (next > before && time > times[before] && sampler.at("interpolation") == "LINEAR") {
                share = (time - times[before]) / (times[next] - times[before]);
            }
            if (share < 1e-5) share = 0;
            std::vector<float> now;
            for (std::size_t c = 0; c < width; ++c) {
                now.push_back(static_cast<float>((1 - share) * values[before * width + c] +
                                                 share * values[next * width + c]));
            }
            return now;
        }
    }
    return still;
}

bool Glb::is_shown(int node, double time) const {
    for (int at = node; at >= 0; at = parent_.at(std::size_t(at))) {
        const std::vector<float> scale = value(at, "scale", time);
        if (scale.empty()) continue;
        CHECK((scale == std::vector<float>{0, 0, 0} || scale == std::vector<float>{1, 1, 1}));
        if (scale[0] == 0) return false;
    }
    return true;
}

Eigen::Matrix4d Glb::world_from_node(int node, double time) const {
    Eigen::Matrix4d all = Eigen::Matrix4d::Identity();
    for (int at = node; at >= 0; at = parent_.at(std::size_t(at))) {
        Eigen::Matrix4d own = Eigen::Matrix4d::Identity();
        if (const auto q = value(at, "rotation", time); !q.empty()) {
            own.block<3, 3>(0, 0) = Quat(q[3], q[0], q[1], q[2]).normalized().toRotationMatrix();
        }
        if (const auto t = value(at, "translation", time); !t.empty()) {
            own.block<3, 1>(0, 3) = Vec3(t[0], t[1], t[2]);
        }
        all = own * all;
    }
    return all;
}

std::vector<Vec3> Glb::corners(int node, std::size_t primitive, const char* attribute,
                               double time) const {
    const Json& mesh = document.at("meshes").at(
        document.at("nodes").at(std::size_t(node)).at("mesh").get<std::size_t>());
    const Json& of = mesh.at("primitives").at(primitive);
    const auto vectors = [&](const Json& shape) {
        const std::vector<float> all = numbers(shape.at(attribute));
        std::vector<Vec3> vector;
        for (std::size_t n = 0; n < all.size(); n += 3) {
            vector.emplace_back(all[n], all[n + 1], all[n + 2]);
        }
        return vector;
    };
    std::vector<Vec3> place = vectors(of.at("attributes"));
    const std::vector<float> weight = value(node, "weights", time);
    CHECK(of.value("targets", Json::array()).size() == weight.size());
    for (std::size_t n = 0; n < weight.size(); ++n) {
        if (weight[n] == 0) continue;
        const std::vector<Vec3> way = vectors(of.at("targets").at(n));
        for (std::size_t v = 0; v < place.size(); ++v) place[v] += double(weight[n]) * way[v];
    }
    std::vector<Vec3> corner;
    for (const std::uint32_t index : indices(of.at("indices"))) corner.push_back(place.at(index));
    return corner;
}

}  // namespace swage::test
