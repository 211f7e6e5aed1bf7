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


class Bytes:
    def __init__(self, data):
        self.data, self.at = data, 0

    def byte(self):
        self.at += 1
        return self.data[self.at - 1]

    def varint(self):
        value = shift = 0
        while True:
            byte = self.byte()
            value |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                return value

    def take(self, count):
        self.at += count
        assert self.at <= len(self.data)
        return self.data[self.at - count:self.at]

    def question_tree(self):
        """A question and two trees, or a probability out of 2^14. Takes whole bytes."""
        pool = []  # bits of the last byte that are left

        def number(count):
            while len(pool) < count:
                pool.extend(bits_of([self.byte()]))
            value = sum(bit << i for i, bit in enumerate(pool[:count]))
            del pool[:count]
            return value

        def node():
            if number(1):
                question = number(6)
                return question, node(), node()
            code = number(8)
            h, z = code & 127, code >> 7
            s = h if h < 8 else (8 + h % 8) << (h // 8 - 1)
            return 2**14 - s if z else s

        tree = node()
        assert not any(pool)
        return tree


class RangeDecoder:
    def __init__(self, data):
        self.data, self.at, self.range, self.code = data, 4, 2**32 - 1, int.from_bytes((data + bytes(4))[:4], "big")

    def bit(self, ones):
        unit = self.range >> 14
        bit = self.code < unit * ones
        start, size = (0, ones) if bit else (ones, 2**14 - ones)
        self.code -= unit * start
        self.range = unit * size
        while self.range < 2**24:
            self.range <<= 8
            self.code = self.code << 8 | (self.data[self.at] if self.at < len(self.data) else 0)
            self.at += 1
        return int(bit)


def gamma_numbers(data):
    bits, numbers = bits_of(data), []
    end = max(i for i, bit in enumerate(bits) if bit) if any(bits) else 0
    at = 0
    while at < end:
        zeros = bits[at:].index(1)
        at += zeros + 1
        numbers.append(1 << zeros | sum(bit << i for i, bit in enumerate(bits[at:at + zeros])))
        at += zeros
    return numbers


class Gotsman:
    """All rows out of a payload over a tree of rows, given as the children and the row of each node."""

    def __init__(self, codec, columns, children, row_of_node, index, payload):
        self.codec, self.columns, self.children = codec, columns, children
        payload, sizes = Bytes(payload), Bytes(index)
        everything = payload.byte()
        if codec == "gotsman3-context":
            self.trees = payload.question_tree(), payload.question_tree()
        seen = range(columns) if everything else self.root(payload.take(sizes.varint()))
        self.parts = {node: payload.take(sizes.varint()) for node in range(len(children)) if children[node]}
        assert payload.at == len(payload.data) and sizes.at == len(sizes.data)
        self.rows = {}
        waiting = [(0, list(seen), [], False)]
        while waiting:
            node, seen, siblings, first = waiting.pop()
            if not children[node]:
                self.rows[row_of_node[node]] = seen
                continue
            b, c = self.split(node, seen, siblings, first)
            waiting.append((children[node][0], b, [set(c)] + siblings, True))
            waiting.append((children[node][1], c, [set(b)] + siblings, False))

    def root(self, data):
        if self.codec != "gotsman3-context":
            return [column for column, bit in enumerate(bits_of(data)) if bit]
        ids, column, numbers = [], -1, gamma_numbers(data)
        for gap, count in zip(numbers[::2], numbers[1::2]):
            column += gap
            ids += range(column, column + count)
            column += count
        return ids

    def leafs(self, node):
        return sum(map(self.leafs, self.children[node])) if self.children[node] else 1

    def split(self, node, a, siblings, first):
        bits = iter(bits_of(self.parts[node]))
        if self.codec == "gotsman1":
            sets = [[column for column in range(self.columns) if next(bits)] for _ in range(2)]
            assert sorted({*sets[0], *sets[1]}) == a
            return sets
        if self.codec == "gotsman2":
            return [[column for column in a if next(bits)] for _ in range(2)]
        if self.codec == "gotsman3":
            b = [column for column in a if next(bits)]
            return b, [column for column in a if column not in b or next(bits)]
        trits, of_column, decoder, seen = [], {}, RangeDecoder(self.parts[node]), set(a)
        history = {column: tuple(column in s for s in siblings) + (False,) * 8 for column in a}
        leafs = self.leafs(node)
        for i, p in enumerate(a):
            answers = [0] * 44

            def trit(at, value):
                answers[at], answers[at + 1] = value & 1, value >> 1

            def last_like(length):
                return next((of_column[q] for q in reversed(a[:i]) if history[q][:length] == history[p][:length]), 0)

            trit(0, of_column.get(p - 1, 0))
            trit(2, of_column.get(p - 2, 0))
            answers[4], answers[5] = p + 1 in seen, p + 2 in seen
            trit(6, trits[-1] if i > 0 else 0)
            trit(8, trits[-2] if i > 1 else 0)
            answers[10:14] = history[p][:4]
            for at, length in zip(range(14, 26, 2), (1, 2, 4, 6, 8, None)):
                trit(at, last_like(length))
            if i > 0:
                answers[26] = history[a[i - 1]][:4] == history[p][:4]
                answers[27] = history[a[i - 1]] == history[p]
            answers[28] = i >= 5 and len(set(trits[-5:])) == 1
            answers[29] = i >= 17 and len(set(trits[-17:])) == 1
            ones, twos, n = (trits.count(value) for value in (1, 2, 3))
            answers[30:38] = (2 * n > i, 4 * n > 3 * i, 8 * n > 7 * i, 32 * n > 31 * i, 4 * n < i, ones > twos,
                              ones > 3 * twos, twos > 3 * ones)
            answers[38:43] = (leafs <= most for most in (2, 4, 8, 32, 128))
            answers[43] = first

            def bit(tree):
                while isinstance(tree, tuple):
                    tree = tree[2 if answers[tree[0]] else 1]
                return decoder.bit(tree)

            trits.append(3 if bit(self.trees[0]) else 2 if bit(self.trees[1]) else 1)
            of_column[p] = trits[-1]
        return [p for p in a if of_column[p] & 1], [p for p in a if of_column[p] & 2]


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

    def test_the_pages_gotsman_vectors(self):
        matrices = {
            "small": (8, [[0, 1, 2, 5], [0, 1, 2, 6], [1, 2, 3, 6], [3, 6]]),
            "large": (64, [[c for c in range(64) if (c - 3 * r) % 64 < 12 or (c % 8 == 0 and r % 4 < 2 and c < 60 and c != 24)]
                           for r in range(16)]),
        }
        vectors = re.findall(r"^\| `(gotsman[^`]*)` \| (small|large) \| `([0-9a-f]+)` \| `([0-9a-f]+)` \|$", PAGE, re.M)
        self.assertEqual(len(vectors), 5)
        for codec, matrix, index, payload in vectors:
            columns, rows = matrices[matrix]
            n = len(rows)
            children = [(2 * i + 1, 2 * i + 2) if i < n - 1 else () for i in range(2 * n - 1)]
            read = Gotsman(codec, columns, children, range(1 - n, n), bytes.fromhex(index), bytes.fromhex(payload))
            self.assertEqual([read.rows[r] for r in range(n)], rows, f"{codec}, {matrix}")

    def test_what_the_program_writes_over_a_tree_of_rows(self):
        random.seed(2)
        lines, seen = [], set(range(40, 90))
        for r in range(150):
            for _ in range(3):
                seen ^= set(range(start := random.randrange(200), start + random.randrange(9)))
            lines += [f"{r + 1} {c + 1}" for c in sorted(seen)]
        rows = [[] for _ in range(150)]
        for line in lines:
            r, c = map(int, line.split())
            rows[r - 1].append(c - 1)
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            (folder / "m.mtx").write_text(f"%%MatrixMarket matrix coordinate pattern general\n150 220 {len(lines)}\n" + "\n".join(lines) + "\n")
            subprocess.run([VISMAT, "tree", folder / "m.mtx", "--side", "rows", "--by", "sets", "-o", folder / "m.bsp.h5"], check=True, capture_output=True)
            for codec in ("gotsman1", "gotsman2", "gotsman3", "gotsman3-context"):
                subprocess.run([VISMAT, "encode", folder / "m.bsp.h5", "--codec", codec, "-o", folder / "m.vmat"], check=True, capture_output=True)
                file = File((folder / "m.vmat").read_bytes())
                tree = Bytes(file.sections["row tree"])
                self.assertEqual(tree.varint(), 150)
                count = tree.varint()
                children = [[] for _ in range(count)]
                for node in range(1, count):
                    children[node - tree.varint()].append(node)
                row_of_node = [tree.varint() - 1 for _ in range(count)]
                read = Gotsman(codec, file.columns, children, row_of_node, file.sections["index"], file.sections["payload"])
                self.assertEqual([read.rows[r] for r in range(150)], rows, codec)
                said = subprocess.run([VISMAT, "row", folder / "m.vmat", "17"], check=True, capture_output=True, text=True).stdout
                self.assertEqual(list(map(int, said.split())), rows[17], codec)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
