"""docs/vmat.md read as someone would who writes a reader in another language: this one knows the page and nothing of our code.
It reads the page's own file byte by byte, and larger ones that the program wrote.

    vmat_format_test.py SOURCE_TREE VISMAT
"""
import pathlib
import random
import re
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib

SOURCE, VISMAT = pathlib.Path(sys.argv[1]), sys.argv[2]
PAGE = (SOURCE / "docs/vmat.md").read_text()


def bits_of(data):
    """The bits of bytes, the lowest of each first."""
    return [byte >> i & 1 for byte in data for i in range(8)]


class File:
    def __init__(self, data):
        magic, version, self.rows, self.columns, self.ones = struct.unpack_from("<8sIIIQ", data)
        assert magic == bytes.fromhex("89564d41540d0a1a") and version == 3
        self.codec = data[28:60].rstrip(b"\0").decode()
        sizes = struct.unpack_from("<10Q", data, 60)
        of_sums, of_head = struct.unpack_from("<2I", data, 140)
        assert zlib.crc32(data[:144]) == of_head
        blocks = -(-sum(sizes) // 4096)
        sums, body = data[148:148 + 4 * blocks], data[148 + 4 * blocks:]
        assert len(body) == sum(sizes) and zlib.crc32(sums) == of_sums
        for block in range(blocks):
            assert zlib.crc32(body[4096 * block:4096 * (block + 1)]) == struct.unpack_from("<I", sums, 4 * block)[0]
        self.sections = {}
        names = ("facts", "tree", "row tree", "row order", "column order", "row groups", "column groups", "boundaries",
                 "index", "payload")
        for name, size in zip(names, sizes):
            self.sections[name], body = body[:size], body[size:]

    def places(self):
        """Where each row's bytes begin, and the payload's end."""
        index, n, u = self.sections["index"], self.rows + 1, len(self.sections["payload"])
        if not index:
            return [row * u // self.rows for row in range(n)]
        b = 0 if u < 2 * n else (u // n).bit_length() - 1
        words = [-(-n // 64), -(-(n + (u >> b) + 1) // 64), -(-n * b // 64)]
        assert len(index) == 8 * sum(words)
        high = bits_of(index[8 * words[0]:8 * (words[0] + words[1])])
        low = bits_of(index[8 * (words[0] + words[1]):])
        set_bits = [place for place, bit in enumerate(high) if bit]
        samples = struct.unpack_from(f"<{words[0]}Q", index)
        assert list(samples) == set_bits[::64] and len(set_bits) == n
        return [((place - i) << b) + sum(low[i * b + j] << j for j in range(b)) for i, place in enumerate(set_bits)]

    def row(self, row):
        places = self.places()
        data = self.sections["payload"][places[row]:places[row + 1]]
        if self.codec == "bitmap" or len(data) == -(-self.columns // 8):  # the escape
            return [column for column, bit in enumerate(bits_of(data)) if bit]
        assert self.codec == "delimiter"
        numbers, ids, column = delimiter_numbers(data), [], 0
        for i, (gap, count) in enumerate(zip(numbers[::2], numbers[1::2])):
            column += gap - (i == 0)
            ids += range(column, column + count)
            column += count
        return ids


def delimiter_code(number):
    text = bin(number)[2:].replace("11", "110")
    return text + "1" if text.endswith("01") or text == "1" else text


def delimiter_bytes(numbers):
    text = "11".join(map(delimiter_code, numbers)) + "1" if numbers else ""
    text += "0" * (-len(text) % 8)
    return bytes(int(text[i:i + 8][::-1], 2) for i in range(0, len(text), 8))


def delimiter_numbers(data):
    """By trying: the codes of numbers in turn that the bits can begin with, until one way leads to the end."""
    text = "".join(map(str, bits_of(data))).rstrip("0")[:-1]
    ways = [(0, [])]
    while ways:
        at, numbers = ways.pop()
        for length in range(1, min(50, len(text) - at) + 1):
            code, end = text[at:at + length], at + length
            plain = code[:-1] if code.endswith("11") else code
            number = int(plain.replace("110", "11"), 2) if plain[0] == "1" else 0
            if number and delimiter_code(number) == code:
                if end == len(text):
                    return numbers + [number]
                if text.startswith("111", end):
                    ways.append((end + 2, numbers + [number]))
    assert not data
    return []


class Format(unittest.TestCase):
    def test_the_pages_own_file(self):
        block = re.search(r"^A whole file.*?```\n(.*?)```", PAGE, re.M | re.S).group(1)
        file = File(bytes.fromhex(block))
        self.assertEqual((file.codec, file.rows, file.columns, file.ones), ("delimiter", 3, 40, 5))
        self.assertEqual([file.row(row) for row in range(3)], [[0], [], [3, 4, 5, 39]])
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "page.vmat"
            path.write_bytes(bytes.fromhex(block))
            said = subprocess.run([VISMAT, "row", path, "2"], check=True, capture_output=True, text=True).stdout
            self.assertEqual(said.split(), ["3", "4", "5", "39"])

    def test_the_pages_delimiter_vector(self):
        expected = re.search(r"^\| delimiter \| `([0-9a-f]+)` \|$", PAGE, re.M).group(1)
        self.assertEqual(delimiter_bytes([5, 2, 1, 1, 3, 1, 70, 4, 1, 2]).hex(), expected)

    def test_what_the_program_writes(self):
        random.seed(1)
        rows = [sorted(random.sample(range(300), count)) for count in (0, 1, 5, 300, 150, 20, 3)] * 30
        rows.append(list(range(40, 260)))
        lines = [f"{r + 1} {c + 1}" for r, row in enumerate(rows) for c in row]
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            (folder / "m.mtx").write_text(f"%%MatrixMarket matrix coordinate pattern general\n{len(rows)} 300 {len(lines)}\n" + "\n".join(lines) + "\n")
            for codec in ("delimiter", "bitmap"):
                subprocess.run([VISMAT, "encode", folder / "m.mtx", "--codec", codec, "-o", folder / "m.vmat"], check=True, capture_output=True)
                file = File((folder / "m.vmat").read_bytes())
                for r, row in enumerate(rows):
                    self.assertEqual(file.row(r), row, f"{codec}, row {r}")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
