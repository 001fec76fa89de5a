// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/exr.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfOutputFile.h>
#include <half.h>

#include <algorithm>
#include <cstdint>
#include <exception>
#include <new>
#include <utility>

#include "base/error.h"

namespace swage {

namespace {

class TextStream : public Imf::OStream {
  public:
    TextStream() : OStream("") {}

    void write(const char bytes[], int count) override {
        const auto size = static_cast<std::size_t>(count);
        text.resize(std::max(text.size(), at_ + size));
        text.replace(at_, size, bytes, size);
        at_ += size;
    }
    std::uint64_t tellp() override { return at_; }
    void seekp(std::uint64_t at) override { at_ = at; }

    std::string text;

  private:
    std::size_t at_ = 0;
};

}  // namespace

std::string encode_exr(int width, int height, const std::vector<ExrChannel>& channels) {
    TextStream stream;
    try {
        Imf::Header header(width, height);
        Imf::FrameBuffer pixels;
        std::vector<std::vector<Imath::half>> halves;
        for (const ExrChannel& channel : channels) {
            const Imf::PixelType type = channel.half ? Imf::HALF : Imf::FLOAT;
            const void* value = channel.value.data();
            if (channel.half) {
                halves.emplace_back(channel.value.begin(), channel.value.end());
                value = halves.back().data();
            }
            header.channels().insert(channel.name, Imf::Channel(type));
            pixels.insert(channel.name, Imf::Slice::Make(type, value, header.dataWindow()));
        }
        Imf::OutputFile file(stream, header, 0);  // no threads
        file.setFrameBuffer(pixels);
        file.writePixels(height);
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) {
        fail(ExitCode::output, "OpenEXR: {}", error.what());
    }
    return std::move(stream.text);
}

}  // namespace swage
