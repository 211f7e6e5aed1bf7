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
        if self.codec == "panne":
            model = Clusters(self.sections["payload"][:places[0]], self.columns)
            return model.row(data)
        assert self.codec == "delimiter"
        numbers, ids, column = delimiter_numbers(data), [], 0
        for i, (gap, count) in enumerate(zip(numbers[::2], numbers[1::2])):
            column += gap - (i == 0)
            ids += range(column, column + count)
            column += count
        return ids


class Bits:
    """Bits from the lowest of each byte on, codes and lengths among them."""

    def __init__(self, data):
        self.bits, self.at = bits_of(data), 0

    def take(self, count):
        self.at += count
        assert self.at <= len(self.bits)
        return self.bits[self.at - count:self.at]

    def symbol(self, code):
        text = ""
        while text not in code:
            assert len(text) < 15
            text += str(self.take(1)[0])
        return code[text]

    def length(self, code):
        """A length, and which hundred and sixty-eight its symbol is of."""
        kind, symbol = divmod(self.symbol(code), 168)
        if symbol < 64:
            return symbol + 1, kind
        e, mm = 6 + (symbol - 64) // 4, (symbol - 64) % 4
        raw = sum(bit << i for i, bit in enumerate(self.take(e - 2)))
        return (1 << e) + (mm << (e - 2)) + raw, kind

    def finish(self):
        assert len(self.bits) - self.at < 8 and not any(self.bits[self.at:])


def huffman_code(data, at, symbols):
    """Symbols by their codes as text, and where the code's bytes end."""
    lengths = []
    while len(lengths) < symbols:
        lengths += [data[at] & 15] * ((data[at] >> 4) + 1)
        at += 1
    assert len(lengths) == symbols
    codes, code, last = {}, 0, 0
    for length, symbol in sorted((length, symbol) for symbol, length in enumerate(lengths) if length):
        code <<= length - last
        codes[format(code, f"0{length}b")], last = symbol, length
        code += 1
    return codes, at


class Clusters:
    """The model of codec panne."""

    def __init__(self, model, columns):
        clusters, at, shift = 0, 0, 0
        while True:
            byte, at = model[at], at + 1
            clusters |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                break
        self.steps, at = huffman_code(model, at, 3 * 168 + 1)
        self.runs, at = huffman_code(model, at, 168)
        self.at_column = [[] for _ in range(columns)]  # a cluster: its lead, its steps
        if clusters:
            self.ranks, at = huffman_code(model, at, 168)
            leads, at = huffman_code(model, at, 168)
            heads, at = huffman_code(model, at, 168)
            bits = Bits(model[at:])
            counts = [bits.length(heads)[0] - 1 for _ in range(columns)]
            assert sum(counts) == clusters
            for column, count in enumerate(counts):
                for _ in range(count):
                    self.at_column[column].append((bits.length(leads)[0] - 1, self.read_steps(bits)))
            bits.finish()
        else:
            assert at == len(model)

    def read_steps(self, bits):
        steps = []
        while True:
            number, kind = bits.length(self.steps)
            if kind == 3:
                return steps
            code = (None, self.runs, self.ranks)[kind] if kind else None
            steps.append((number - 1, kind, bits.length(code)[0] if code else 1))

    def follow(self, steps, reach):
        """Ids of steps in turn, and where each begins and reaches to."""
        ids, places = [], []
        for zeros, kind, count in steps:
            begin = reach + zeros
            if kind == 2:
                inner, reach = self.cluster(begin, count)
                ids += inner
            else:
                reach = begin + (count + 1 if kind else 1)
                ids += range(begin, reach)
            places.append((begin, reach))
        return ids, places

    def cluster(self, column, rank):
        lead, steps = self.at_column[column][rank - 1]
        ids, reach = self.cluster(column, lead) if lead else ([column], column + 1)
        more, places = self.follow(steps, reach)
        for begin, end in places:
            if begin == reach:
                reach = end
        return ids + more, reach

    def row(self, data):
        if not data:
            return []
        bits = Bits(data)
        steps = self.read_steps(bits)
        bits.finish()
        ids = sorted(self.follow(steps, 0)[0])
        assert steps and len(set(ids)) == len(ids)
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

    def test_the_pages_clusters(self):
        model, row = re.search(r"^A model and a row of 24 columns: `([0-9a-f]+)`\n`([0-9a-f]+)`", PAGE, re.M).groups()
        self.assertEqual(Clusters(bytes.fromhex(model), 24).row(bytes.fromhex(row)), [1, 3, 5, 6, 8, 20, 21, 22])

    def test_what_the_program_writes(self):
        random.seed(1)
        rows = [sorted(random.sample(range(300), count)) for count in (0, 1, 5, 300, 150, 20, 3)] * 30
        rows.append(list(range(40, 260)))
        lines = [f"{r + 1} {c + 1}" for r, row in enumerate(rows) for c in row]
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            (folder / "m.mtx").write_text(f"%%MatrixMarket matrix coordinate pattern general\n{len(rows)} 300 {len(lines)}\n" + "\n".join(lines) + "\n")
            for codec in ("delimiter", "bitmap", "panne"):
                subprocess.run([VISMAT, "encode", folder / "m.mtx", "--codec", codec, "-o", folder / "m.vmat"], check=True, capture_output=True)
                file = File((folder / "m.vmat").read_bytes())
                for r, row in enumerate(rows):
                    self.assertEqual(file.row(r), row, f"{codec}, row {r}")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
