// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <unistd.h>

#include <utility>

namespace swage {

class FileHandle {  // a file descriptor, closed with it
  public:
    explicit FileHandle(int id = -1) : id_(id) {}
    FileHandle(FileHandle&& other) noexcept : id_(std::exchange(other.id_, -1)) {}
    FileHandle& operator=(FileHandle&& other) noexcept {
        std::swap(id_, other.id_);
        return *this;
    }
    ~FileHandle() { close(); }
    int id() const { return id_; }
    bool is_open() const { return id_ >= 0; }
    void close() {
        if (is_open()) ::close(id_);
        id_ = -1;
    }

  private:
    int id_;
};

}  // namespace swage
