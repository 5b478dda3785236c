// NumPy's .npy files for ports in C++17: little-endian, C order, versions 1 to 3. One header, no dependencies.
//
//     npy::Array<double> heights = npy::read<double>("case/inputs/polygon0.height_map.npy");
//     npy::write("drawn/march.hit_index.npy", indices);                     // an npy::Array<std::int32_t>

#pragma once

#include <cstdint>
#include <cstring>
#include <fstream>
#include <functional>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

namespace npy {

template <class T>
struct Array {
    std::vector<std::size_t> shape;
    std::vector<T> data;    // the last axis runs fastest
};

inline std::size_t count(const std::vector<std::size_t>& shape) {
    return std::accumulate(shape.begin(), shape.end(), std::size_t{1}, std::multiplies<>{});
}

namespace detail {

template <class T> inline const char* kind();
template <> inline const char* kind<double>() { return "<f8"; }
template <> inline const char* kind<float>() { return "<f4"; }
template <> inline const char* kind<std::int64_t>() { return "<i8"; }
template <> inline const char* kind<std::int32_t>() { return "<i4"; }
template <> inline const char* kind<std::uint8_t>() { return "|u1"; }
template <> inline const char* kind<bool>() { return "|b1"; }

inline std::string field(const std::string& header, const std::string& name, char first, char last) {
    const auto at = header.find("'" + name + "'");
    const auto start = at == std::string::npos ? at : header.find(first, header.find(':', at));
    const auto stop = start == std::string::npos ? start : header.find(last, start + 1);
    if (stop == std::string::npos) throw std::runtime_error("npy: no " + name + " in the header " + header);
    return header.substr(start + 1, stop - start - 1);
}

template <class T, class Stored>
void body(std::ifstream& file, std::vector<T>& result, std::size_t size) {
    std::vector<char> bytes(size * sizeof(Stored));
    if (!file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) throw std::runtime_error("npy: too short");
    result.resize(size);
    for (std::size_t i = 0; i < size; ++i) {
        Stored number;
        std::memcpy(&number, bytes.data() + i * sizeof(Stored), sizeof(Stored));
        result[i] = static_cast<T>(number);
    }
}

}  // namespace detail

/// A file's array, its numbers converted to T. Throws std::runtime_error for what it is not made for.
template <class T>
Array<T> read(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    unsigned char start[12] = {};
    if (!file.read(reinterpret_cast<char*>(start), 10) || std::memcmp(start, "\x93NUMPY", 6) != 0)
        throw std::runtime_error(path + ": is no .npy file");
    std::size_t length = start[8] | start[9] << 8;
    if (start[6] >= 2) {
        file.read(reinterpret_cast<char*>(start + 10), 2);
        length |= static_cast<std::size_t>(start[10]) << 16 | static_cast<std::size_t>(start[11]) << 24;
    }
    if (length > 65536) throw std::runtime_error(path + ": a header of more than 64 KiB");
    std::string header(length, ' ');
    file.read(header.data(), static_cast<std::streamsize>(length));
    if (header.find("'fortran_order': False") == std::string::npos) throw std::runtime_error(path + ": not in C order");
    Array<T> array;
    std::string sizes = detail::field(header, "shape", '(', ')') + ",";
    for (std::size_t at = 0, comma; (comma = sizes.find(',', at)) != std::string::npos; at = comma + 1) {
        const auto part = sizes.substr(at, comma - at);
        if (part.find_first_not_of(' ') != std::string::npos) array.shape.push_back(std::stoull(part));
    }
    const auto kind = detail::field(header, "descr", '\'', '\'');
    const auto size = count(array.shape);
    if (kind == "<f8") detail::body<T, double>(file, array.data, size);
    else if (kind == "<f4") detail::body<T, float>(file, array.data, size);
    else if (kind == "<i8") detail::body<T, std::int64_t>(file, array.data, size);
    else if (kind == "<i4") detail::body<T, std::int32_t>(file, array.data, size);
    else if (kind == "|u1" || kind == "|b1") detail::body<T, std::uint8_t>(file, array.data, size);
    else throw std::runtime_error(path + ": numbers of type " + kind);
    return array;
}

template <class T>
void write(const std::string& path, const Array<T>& array) {
    if (array.data.size() != count(array.shape)) throw std::runtime_error(path + ": the shape has another size");
    std::string shape;
    for (const auto size : array.shape) shape += std::to_string(size) + ", ";
    std::string header = "{'descr': '" + std::string(detail::kind<T>()) + "', 'fortran_order': False, 'shape': (" + shape + "), }";
    header += std::string(63 - (10 + header.size()) % 64, ' ') + "\n";
    std::ofstream file(path, std::ios::binary);
    const char start[10] = {'\x93', 'N', 'U', 'M', 'P', 'Y', 1, 0, static_cast<char>(header.size() & 255),
                            static_cast<char>(header.size() >> 8)};
    file.write(start, 10);
    file.write(header.data(), static_cast<std::streamsize>(header.size()));
    for (const T number : array.data) file.write(reinterpret_cast<const char*>(&number), sizeof(T));
    if (!file) throw std::runtime_error(path + ": not written");
}

}  // namespace npy
