// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef PYMESHLAB_FCD_POSE_STATE_H
#define PYMESHLAB_FCD_POSE_STATE_H

#include <vcg_ext/base/error.h>
#include <vcg_ext/compensate.h>
#include <vcg_ext/map/moving_surface.h>

#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <type_traits>
#include <vector>

/// \file
/// Solutions as bytes, for pickles. Writer and reader use the same lists of fields (fieldsOf).

/// The fields of each type, in the order in which they are written.
template <class Take>
void fieldsOf(vcg::fcd::HeldMotions &given, const Take &take) {
    take(given.motion, given.rotates, given.turn, given.pointMotion);
}
template <class Take>
void fieldsOf(vcg::fcd::GraphPose &pose, const Take &take) {
    take(pose.position, pose.linear, pose.energy, pose.nodeEnergy, pose.rests, pose.iterations, pose.converged,
         pose.moves, pose.followed, pose.unstable, pose.affine);
}
template <class Take>
void fieldsOf(vcg::fcd::RegionPose &pose, const Take &take) {
    take(pose.given, pose.solved, pose.graph, pose.nodeMotion, pose.motion, pose.iterations, pose.path.steps,
         pose.path.jumps, pose.path.unstable);
}
template <class Take>
void fieldsOf(vcg::fcd::SurfacePose &pose, const Take &take) {
    take(pose.given, pose.region, pose.iterations, pose.path.steps, pose.path.jumps, pose.path.unstable, pose.converged,
         pose.energy);
}

template <class Take>
void fieldsOf(vcg::fcd::Compensation &compensation, const Take &take) {
    compensation.Fields(take);
}

/// A kind of state.
struct StateKind {
    const char *mark;    ///< its first bytes
    const char *refusal; ///< message for other bytes
};
inline constexpr StateKind poseState{"fcd pose 4\n",
                                     "The pose was kept by another version of this package, or is damaged: pose the "
                                     "surface anew."};
inline constexpr StateKind compensationState{
    "fcd compensation 2\n", "The compensation was kept by another version of this package, or is damaged: "
                            "compensate the part anew."};

/// Values that are written as their bytes: numbers, and matrices of fixed size.
template <class T>
struct IsPlain : std::is_arithmetic<T> {};
template <class T, int rows, int columns>
struct IsPlain<Eigen::Matrix<T, rows, columns>>
    : std::bool_constant<rows != Eigen::Dynamic && columns != Eigen::Dynamic> {};
template <class T>
struct IsPlain<Eigen::Transform<T, 3, Eigen::Affine>> : std::true_type {};

/// A checksum of bytes (FNV-1a).
inline std::uint64_t stateSum(const char *bytes, std::size_t size) {
    std::uint64_t sum = 0xCBF29CE484222325u;
    for (std::size_t i = 0; i < size; ++i)
        sum = (sum ^ static_cast<unsigned char>(bytes[i])) * 0x100000001B3u;
    return sum;
}

/// Writes values one after the other, in this machine's byte order, and their checksum.
class StateWriter {
  public:
    explicit StateWriter(const StateKind &kind) : text(kind.mark) {}

    /// All bytes.
    std::string Sealed() && {
        put(stateSum(text.data(), text.size()));
        return std::move(text);
    }

    template <class... T>
    void operator()(const T &...value) {
        (put(value), ...);
    }

  private:
    void raw(const void *data, std::size_t size) { text.append(static_cast<const char *>(data), size); }

    template <class T>
    void put(const T &value) {
        if constexpr (IsPlain<T>::value)
            raw(&value, sizeof value);
        else
            fieldsOf(const_cast<T &>(value), [this](const auto &...field) { (*this)(field...); });
    }
    template <class T>
    void put(const std::vector<T> &values) {
        put(values.size());
        for (const T &each : values)
            put(each);
    }
    template <class Key, class T>
    void put(const std::map<Key, T> &values) {
        put(values.size());
        for (const auto &[key, each] : values) {
            put(key);
            put(each);
        }
    }
    void put(const Eigen::Matrix3Xd &columns) {
        put(std::size_t(columns.cols()));
        raw(columns.data(), sizeof(double) * std::size_t(columns.size()));
    }

    std::string text;
};

/// Reads what StateWriter has written. \throw BadInput other bytes, or changed ones
class StateReader {
  public:
    StateReader(const StateKind &kind, std::string given)
        : kind(kind), text(std::move(given)), at(std::strlen(kind.mark)) {
        std::uint64_t sum = 0;
        if (text.compare(0, at, kind.mark) != 0 || text.size() < at + sizeof sum)
            Fail();
        const std::size_t size = text.size() - sizeof sum;
        std::memcpy(&sum, text.data() + size, sizeof sum);
        if (sum != stateSum(text.data(), size))
            Fail();
        text.resize(size);
    }

    template <class... T>
    void operator()(T &...value) {
        (get(value), ...);
    }

    void ExpectEnd() const {
        if (at != text.size())
            Fail();
    }

  private:
    [[noreturn]] void Fail() const { throw vcg::fcd::BadInput(kind.refusal); }

    void raw(void *data, std::size_t size) {
        if (size > text.size() - at)
            Fail();
        std::memcpy(data, text.data() + at, size);
        at += size;
    }

    /// The number of items that follow, each of at least a byte.
    std::size_t count() {
        std::size_t n = 0;
        raw(&n, sizeof n);
        if (n > text.size() - at)
            Fail();
        return n;
    }

    template <class T>
    void get(T &value) {
        if constexpr (std::is_same_v<T, bool>) {
            char byte = 0;
            raw(&byte, 1);
            value = byte != 0;
        } else if constexpr (IsPlain<T>::value)
            raw(static_cast<void *>(&value), sizeof value);
        else
            fieldsOf(value, [this](auto &...field) { (*this)(field...); });
    }
    template <class T>
    void get(std::vector<T> &values) {
        values.resize(count());
        for (T &each : values)
            get(each);
    }
    template <class Key, class T>
    void get(std::map<Key, T> &values) {
        for (std::size_t n = count(); n > 0; --n) {
            Key key{};
            get(key);
            get(values[key]);
        }
    }
    void get(Eigen::Matrix3Xd &columns) {
        const std::size_t n = count();
        columns.resize(3, Eigen::Index(n));
        raw(columns.data(), sizeof(double) * 3 * n);
    }

    const StateKind kind;
    std::string text;
    std::size_t at;
};

#endif
