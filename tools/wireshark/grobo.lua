-- SPDX-License-Identifier: MIT
--
-- Wireshark and tshark: traces of `grctl --trace FILE` (pcapng, link type USER0).
--
--   wireshark -X lua_script:tools/wireshark/grobo.lua walk.pcapng
--   tshark -X lua_script:tools/wireshark/grobo.lua -r walk.pcapng
--
-- or copy it into the folder that Help > About > Folders names "Personal Lua Plugins".
--
-- A packet of a trace is a chunk as one read or write of the line gave it: half a frame, or three.
-- Chunks of a direction are put together here; a frame is shown in the packet with its last byte.
-- What counts as a frame, and where the next one begins after rubbish, is decided as by the
-- library (include/grobo/core/rs30x.h, board.h) and `grctl decode`; tests/cli/wireshark.sh compares.

local grobo = Proto("grobo", "GROBO serial servo robot")

local STALL_S = 0.05 -- a frame that stands still for so long is over: GROBO_BOARD_STALL_US
local RUBBISH_MAX = 64
local REQUESTS_MAX = 64
local ALL, REGISTERS, PACKET_MAX, RELAY_MAX = 255, 140, 148, 127

-- GROBO_RS30X_REGISTER_LIST, and what a count is worth: name, address, bytes, signed, unit.
local registers = {
    {"model", 0, 2, 0, ""},
    {"firmware", 2, 1, 0, ""},
    {"id", 4, 1, 0, ""},
    {"reverse", 5, 1, 0, ""},
    {"baud", 6, 1, 0, "code"},
    {"delay", 7, 1, 0, "50 us"},
    {"cw_limit", 8, 2, 1, "0.1 deg"},
    {"ccw_limit", 10, 2, 1, "0.1 deg"},
    {"temperature_limit", 14, 2, 1, "deg C"},
    {"silence_torque", 22, 1, 0, ""},
    {"warm_up_time", 23, 1, 0, ""},
    {"cw_margin", 24, 1, 0, "0.1 deg"},
    {"ccw_margin", 25, 1, 0, "0.1 deg"},
    {"cw_slope", 26, 1, 0, "1 deg"},
    {"ccw_slope", 27, 1, 0, "1 deg"},
    {"punch", 28, 2, 0, "0.01 %"},
    {"goal", 30, 2, 1, "0.1 deg"},
    {"goal_time", 32, 2, 0, "10 ms"},
    {"max_torque", 35, 1, 0, "1 %"},
    {"torque", 36, 1, 0, ""},
    {"position", 42, 2, 1, "0.1 deg"},
    {"time", 44, 2, 0, "10 ms"},
    {"speed", 46, 2, 1, "deg/s"},
    {"current", 48, 2, 0, "mA"},
    {"temperature", 50, 2, 1, "deg C"},
    {"voltage", 52, 2, 0, "10 mV"},
}

-- factor, offset, unit; a factor of no whole number makes a field of type double
local scales = {
    ["0.1 deg"] = {0.1, 0, "deg"},
    ["1 deg"] = {1, 0, "deg"},
    ["10 ms"] = {10, 0, "ms"},
    ["deg/s"] = {1, 0, "deg/s"},
    ["mA"] = {1, 0, "mA"},
    ["10 mV"] = {0.01, 0, "V"},
    ["deg C"] = {1, 0, "deg C"},
    ["1 %"] = {1, 0, "%"},
    ["0.01 %"] = {0.01, 0, "%"},
    ["50 us"] = {50, 100, "us"},
    ["code"] = {1, 0, ""},
    [""] = {1, 0, ""},
}

local words = {
    torque = {[0] = "off", [1] = "on", [2] = "brake"},
    model = {[0x3010] = "RS301CR", [0x3020] = "RS302CD", [0x3030] = "RS303MR", [0x3040] = "RS304MD"},
    baud = {[0] = "9600 bps", "14400 bps", "19200 bps", "28800 bps", "38400 bps", "57600 bps",
            "76800 bps", "115200 bps", "153600 bps", "230400 bps", "460800 bps"},
}

-- GR001's joints by the id of their servo
local joints = {
    "CHEST_P", "NECK_Y", "R_SHOULDER_P", "R_SHOULDER_R", "R_ELBOW_P", "L_SHOULDER_P",
    "L_SHOULDER_R", "L_ELBOW_P", "R_HIP_Y", "R_HIP_P", "R_HIP_R", "R_KNEE_P", "R_ANKLE_P",
    "R_ANKLE_R", "L_HIP_Y", "L_HIP_P", "L_HIP_R", "L_KNEE_P", "L_ANKLE_P", "L_ANKLE_R",
}

local wants = {
    [0] = "nothing", [1] = "ACK", [3] = "No.0-29", [5] = "No.30-59", [7] = "No.20-29",
    [9] = "No.42-59", [11] = "No.30-41", [13] = "No.60-127", [15] = "the given registers",
}
local blocks = {[3] = {0, 30}, [5] = {30, 30}, [7] = {20, 10}, [9] = {42, 18}, [11] = {30, 12},
                [13] = {60, 68}}

-- ---- fields ------------------------------------------------------------------------------------

local fields = {
    from = ProtoField.string("grobo.from", "From"),
    kind = ProtoField.string("grobo.kind", "Kind"),
    count = ProtoField.uint8("grobo.board.count", "Bytes relayed and counted"),
    reply = ProtoField.uint8("grobo.board.reply_bytes", "Bytes to return"),
    number = ProtoField.uint8("grobo.board.number", "Number of the stored motion"),
    header = ProtoField.uint16("grobo.header", "Header", base.HEX,
                               {[0xFAAF] = "command", [0xFDDF] = "return"}),
    id = ProtoField.uint8("grobo.id", "Servo id"),
    joint = ProtoField.string("grobo.joint", "Joint"),
    flags = ProtoField.uint8("grobo.flags", "Flags", base.HEX),
    flash = ProtoField.bool("grobo.flags.flash", "Write No.4-29 to flash", 8, nil, 0x40),
    reboot = ProtoField.bool("grobo.flags.reboot", "Reboot", 8, nil, 0x20),
    factory = ProtoField.bool("grobo.flags.factory", "Factory reset", 8, nil, 0x10),
    wants = ProtoField.uint8("grobo.flags.wants", "Wants", base.DEC, wants, 0x0F),
    overheated = ProtoField.bool("grobo.status.overheated", "Too hot, torque was cut", 8, nil, 0x80),
    hot = ProtoField.bool("grobo.status.hot", "Temperature alarm", 8, nil, 0x20),
    flash_error = ProtoField.bool("grobo.status.flash_error", "Writing to flash failed", 8, nil,
                                  0x08),
    refused = ProtoField.bool("grobo.status.refused", "Could not be processed", 8, nil, 0x02),
    address = ProtoField.uint8("grobo.address", "First register"),
    length = ProtoField.uint8("grobo.length", "Length"),
    servos = ProtoField.uint8("grobo.count", "Count"),
    reserved = ProtoField.bytes("grobo.reserved", "Reserved"),
    sum = ProtoField.uint8("grobo.sum", "Sum", base.HEX),
    sum_ok = ProtoField.bool("grobo.sum_ok", "Sum is right"),
    bytes = ProtoField.bytes("grobo.bytes", "Bytes"),
    continued = ProtoField.framenum("grobo.continued_in", "Goes on in packet"),
    request = ProtoField.framenum("grobo.request_in", "Answers packet", base.NONE,
                                  frametype.REQUEST),
    answer = ProtoField.framenum("grobo.reply_in", "Answered by packet", base.NONE,
                                 frametype.RESPONSE),
    delay = ProtoField.double("grobo.reply_time_ms", "Time from the request, ms"),
}
for _, reg in ipairs(registers) do
    local name, scale = reg[1], scales[reg[5]]
    local make = scale[1] % 1 ~= 0 and ProtoField.double or ProtoField.int32
    local label = scale[3] ~= "" and string.format("%s (%s)", name, scale[3]) or name
    fields["reg_" .. name] = make("grobo.reg." .. name, label)
end
for _, field in pairs(fields) do
    table.insert(grobo.fields, field)
end

local bad_sum = ProtoExpert.new("grobo.bad_sum", "Wrong sum", expert.group.CHECKSUM,
                                expert.severity.ERROR)
local rubbish = ProtoExpert.new("grobo.rubbish", "No frame", expert.group.MALFORMED,
                                expert.severity.WARN)
local refusal = ProtoExpert.new("grobo.refusal", "Refused or in trouble",
                                expert.group.RESPONSE_CODE, expert.severity.WARN)
local unasked = ProtoExpert.new("grobo.unasked", "Nobody asked for it", expert.group.SEQUENCE,
                                expert.severity.WARN)
grobo.experts = {bad_sum, rubbish, refusal, unasked}

-- ---- frames in bytes ---------------------------------------------------------------------------
-- Offsets count from 1, as strings do. A `peek` gives: size of the frame that begins at `at` and
-- its description; 0 when more bytes are needed; nil when none begins there.

local function is_servo(id)
    return id >= 1 and id <= 127
end

local function sum_of(bytes, first, last)
    local sum = 0
    for i = first, last do
        sum = bit.bxor(sum, bytes:byte(i))
    end
    return sum
end

-- Data bytes that a packet's head announces, or nil.
local function announced(bytes, at)
    local id, flags, address, length, count = bytes:byte(at + 2, at + 6)
    if bytes:byte(at) == 0xFD then
        return is_servo(id) and count == 1 and address + length <= REGISTERS and length or nil
    end
    if id == 0 then
        local data = length * count
        return flags == 0 and length >= 2 and data > 0 and data <= PACKET_MAX - 8 and data or nil
    end
    if (not is_servo(id) and id ~= ALL) or count > 1 then
        return nil
    end
    if count == 0 then
        return 0
    end
    return length <= REGISTERS and length or nil
end

local function peek_packet(bytes, at, side)
    local left = #bytes - at + 1
    local first, second, id = bytes:byte(at, at + 2)
    if (first == 0x07 or first == 0x08) and side ~= "host" then
        return 1, {kind = first == 0x07 and "ack" or "nack", sum_ok = true}
    end
    local command = first == 0xFA -- of the robot's side: the echo of an adapter with one wire
    if not command and not (first == 0xFD and side ~= "host") then
        return nil
    end
    if second and second ~= (command and 0xAF or 0xDF) then
        return nil
    end
    if id and not (is_servo(id) or (command and (id == 0 or id == ALL))) then
        return nil
    end
    if left < 7 then
        return 0
    end
    local data = announced(bytes, at)
    if not data then
        return nil
    end
    local size = data + 8
    if left < size then
        return 0
    end
    local _, _, _, flags, address, length, count, value = bytes:byte(at, at + 7)
    if command and bit.band(flags, 0xF0) == 0x10 and address == 0xFF and length == 0xFF and
        count == 0 and value == 0xFF then
        size = size + 1 -- a factory reset has a data byte FF, or has none
        if left < size then
            return 0
        end
    end
    local sum = bytes:byte(at + size - 1)
    return size, {
        kind = command and (side == "robot" and "echo" or "packet") or "return",
        sum_ok = sum == sum_of(bytes, at + 2, at + size - 2),
    }
end

local function peek_relay(bytes, at)
    local left = #bytes - at + 1
    local kind, n, p1, p2 = bytes:byte(at, at + 3)
    local trailer = kind == 0x54 and 1 or 0
    if not n then
        return 0
    end
    if n < 2 + trailer or n > RELAY_MAX or (p1 and p1 ~= 0xFA) or (p2 and p2 ~= 0xAF) then
        return nil
    end
    if left < 2 + n then
        return 0
    end
    local inside = bytes:sub(at + 2, at + 1 + n - trailer)
    local size, packet = peek_packet(inside, 1, "host")
    local whole = size == #inside
    return 2 + n, {
        kind = trailer == 1 and "relay_return" or "relay",
        packet_at = whole and 2 or nil,
        packet_bytes = #inside,
        sum_ok = not whole or packet.sum_ok,
    }
end

local function peek_board(bytes, at)
    local left = #bytes - at + 1
    local first, second = bytes:byte(at, at + 1)
    if first == 0x41 then
        if left < 2 then
            return 0
        end
        if second == 0 then
            return 2, {kind = "check", sum_ok = true}
        end
    elseif first == 0x50 then
        if second and second ~= 0x4D and second ~= 0x53 then
            return nil
        end
        if left < 3 then
            return 0
        end
        return 3, {kind = second == 0x4D and "slot" or "scenario", sum_ok = true}
    elseif first == 0x53 or first == 0x54 then
        return peek_relay(bytes, at)
    end
    return nil
end

local function peek(bytes, at, side)
    local size, found
    if side ~= "robot" then
        size, found = peek_board(bytes, at)
    end
    if not size then
        size, found = peek_packet(bytes, at, side)
        if found and (found.kind == "packet" or found.kind == "return" or found.kind == "echo") then
            found.packet_at, found.packet_bytes = 0, size
        end
    end
    return size, found
end

-- Where a good frame begins inside the `size` bytes at `at`, which are none: offset, `size` where
-- there is none, 0 where more bytes are needed to know.
local function next_start(bytes, at, size, side, ending)
    local open = false
    for i = 1, size - 1 do
        local inner, found = peek(bytes, at + i, side)
        if inner and inner > 1 and found.sum_ok then
            return (open and not ending) and 0 or i
        end
        open = open or inner == 0
    end
    return (open and not ending) and 0 or size
end

-- Takes bytes apart: list of {kind, at, size, ...}, and how many bytes were used up.
local function scan(bytes, side, ending)
    local frames, done, at = {}, 1, 1
    local function hand_out(frame, first, size)
        frame.at, frame.size = first, size
        table.insert(frames, frame)
        done = first + size
        at = done
    end
    local function hand_out_rubbish()
        if at > done then
            hand_out({kind = "rubbish"}, done, at - done)
        end
    end
    while at <= #bytes do
        local size, found = peek(bytes, at, side)
        if size == 0 and not ending then
            break
        elseif not size then
            at = at + 1
            if at - done == RUBBISH_MAX then
                hand_out_rubbish()
            end
        elseif size > 0 and found.sum_ok then
            hand_out_rubbish()
            hand_out(found, at, size)
        else
            local last = size > 0 and size or #bytes - at + 1
            local n = next_start(bytes, at, last, side, ending)
            if n == 0 then
                break
            end
            hand_out_rubbish()
            hand_out((size > 0 and n == last) and found or {kind = "cut"}, at, n)
        end
    end
    if ending or at > #bytes then
        hand_out_rubbish()
    end
    return frames, done - 1
end

-- ---- requests and replies ----------------------------------------------------------------------

-- What a command packet at `at` will be answered by: nil for nothing.
local function expected(bytes, at)
    local id, flags, address, length = bytes:byte(at + 2, at + 5)
    local want = bit.band(flags, 0x0F)
    if id == 0 or id == ALL or want == 0 or want % 2 == 0 then
        return nil
    end
    if want == 1 then
        return "ack"
    end
    if blocks[want] then
        address, length = blocks[want][1], blocks[want][2]
    end
    return string.format("return %d %d %d", id, address, length)
end

local function question(frame, bytes)
    if frame.kind == "check" then
        return "ack"
    end
    local asks = frame.kind == "packet" or frame.kind == "relay_return" -- an echo asks nothing
    if not asks or not frame.packet_at or not frame.sum_ok then
        return nil
    end
    return expected(bytes, frame.at + frame.packet_at)
end

local function reply(frame, bytes)
    if frame.kind == "ack" or frame.kind == "nack" then
        return "ack"
    end
    if frame.kind ~= "return" or not frame.sum_ok then
        return nil
    end
    local id, _, address, length = bytes:byte(frame.at + 2, frame.at + 5)
    return string.format("return %d %d %d", id, address, length)
end

-- ---- state of a file ---------------------------------------------------------------------------

local streams, packets, open_requests, answered

function grobo.init()
    streams = {} -- by side: bytes that wait for more, the time of the last, where they came
    packets = {} -- by packet number: what was found when it was first seen
    open_requests = {} -- in order: {key, number, time, bytes}
    answered = {} -- by number of the request's packet: number of the reply's
end

local function match(frame, bytes, number, time)
    local asks, answers = question(frame, bytes), reply(frame, bytes)
    if asks then
        local said = bytes:sub(frame.at, frame.at + frame.size - 1)
        if #open_requests == REQUESTS_MAX then
            table.remove(open_requests, 1)
        end
        table.insert(open_requests, {asks, number, time, said})
    elseif answers then
        -- The first request that fits, or its last repetition.
        local found, at
        for i, request in ipairs(open_requests) do
            if request[1] == answers and (not found or request[4] == found[4]) then
                found, at = request, i
            end
        end
        if found then
            frame.request, frame.delay_ms = found[2], (time - found[3]) * 1e3
            answered[found[2]] = number
            table.remove(open_requests, at)
            for i = at - 1, 1, -1 do -- the line keeps the order: others before stay without
                if open_requests[i][4] ~= found[4] then
                    table.remove(open_requests, i)
                end
            end
            return
        end
        frame.unasked = true
    end
end

-- First sight of a packet: finds the frames that end in it, keeps what is left for the next.
local function first_sight(number, time, side, chunk)
    local stream = streams[side] or {rest = "", time = time, numbers = {}}
    local seen = {}
    streams[side] = stream
    if #stream.rest > 0 and time - stream.time >= STALL_S then
        seen.before = stream.rest
        seen.before_frames = scan(stream.rest, side, true)
        stream.rest, stream.numbers = "", {}
    end
    seen.prefix = stream.rest
    local bytes = stream.rest .. chunk
    local used
    seen.frames, used = scan(bytes, side, false)
    for _, frame in ipairs(seen.frames) do
        match(frame, bytes, number, time)
    end
    if used > 0 then
        for _, earlier in ipairs(stream.numbers) do
            packets[earlier].continued = number
        end
        stream.numbers = {}
    end
    stream.rest = bytes:sub(used + 1)
    stream.time = time
    if #stream.rest > 0 then
        table.insert(stream.numbers, number)
    end
    packets[number] = seen
    return seen
end

-- ---- showing -----------------------------------------------------------------------------------

local function register_at(address)
    for _, reg in ipairs(registers) do
        if reg[2] == address then
            return reg
        end
    end
end

local function servo_text(id)
    if id == ALL then
        return "all servos"
    end
    return joints[id] and string.format("servo %d (%s)", id, joints[id]) or "servo " .. id
end

local function add_value(tree, range, reg)
    local name, scale = reg[1], scales[reg[5]]
    local raw = reg[4] == 1 and range:le_int() or range:le_uint()
    local value = raw * scale[1] + scale[2]
    local word = words[name] and words[name][raw]
    local text = word or string.format("%.6g%s", value, scale[3] ~= "" and " " .. scale[3] or "")
    tree:add(fields["reg_" .. name], range, value, string.format("%s: %s", name, text))
    return string.format("%s %s", name, text)
end

-- The registers of one servo; returns them as text.
local function add_registers(tree, tvb, at, n, address)
    local list, i = {}, 0
    while i < n do
        local reg = register_at(address + i)
        local size = reg and reg[3] or 1
        if reg and i + size <= n then
            table.insert(list, add_value(tree, tvb(at + i, size), reg))
        else
            size = 1
            local range = tvb(at + i, 1)
            local byte = range:uint()
            local label = string.format("No.%d = %02X", address + i, byte)
            tree:add(fields.reserved, range):set_text(label)
            if byte ~= 0 then
                table.insert(list, label)
            end
        end
        i = i + size
    end
    return table.concat(list, ", ")
end

local function add_joint(tree, range)
    local id = range:uint()
    tree:add(fields.id, range)
    if joints[id] then
        tree:add(fields.joint, range, joints[id]):set_generated()
    end
end

local function add_flags(tree, range, is_return)
    local flags = tree:add(fields.flags, range)
    local names = is_return and {"overheated", "hot", "flash_error", "refused"} or
        {"flash", "reboot", "factory", "wants"}
    for _, name in ipairs(names) do
        flags:add(fields[name], range)
    end
    if is_return and bit.band(range:uint(), 0xAA) ~= 0 then
        flags:add_proto_expert_info(refusal)
    end
end

local function action_of(flags, data)
    if bit.band(flags, 0x10) ~= 0 then
        return "factory reset"
    elseif bit.band(flags, 0x60) == 0x60 then
        return "flash and reboot"
    elseif bit.band(flags, 0x40) ~= 0 then
        return "flash"
    elseif bit.band(flags, 0x20) ~= 0 then
        return "reboot"
    elseif data > 0 then
        return "write"
    end
    local want = bit.band(flags, 0x0F)
    return want == 1 and "ping" or want == 0 and "nothing" or "read"
end

local function add_long(tree, tvb, at, size)
    local address, length, count = tvb(at + 4, 1):uint(), tvb(at + 5, 1):uint(),
        tvb(at + 6, 1):uint()
    local first = ""
    for i = 0, count - 1 do
        local share_at = at + 7 + i * length
        local id = tvb(share_at, 1):uint()
        local share = tree:add(tvb(share_at, length), servo_text(id))
        add_joint(share, tvb(share_at, 1))
        local text = add_registers(share, tvb, share_at + 1, length - 1, address)
        share:append_text(": " .. text)
        first = i == 0 and string.format("%s %s", servo_text(id), text) or first
    end
    return string.format("write %d servos: %s%s", count, first, count > 1 and ", ..." or "")
end

local function add_packet(tree, tvb, at, size)
    local id, flags = tvb(at + 2, 1):uint(), tvb(at + 3, 1):uint()
    local address, length = tvb(at + 4, 1):uint(), tvb(at + 5, 1):uint()
    local is_return = tvb(at, 1):uint() == 0xFD
    local text
    tree:add(fields.header, tvb(at, 2))
    add_joint(tree, tvb(at + 2, 1))
    add_flags(tree, tvb(at + 3, 1), is_return)
    tree:add(fields.address, tvb(at + 4, 1))
    tree:add(fields.length, tvb(at + 5, 1))
    tree:add(fields.servos, tvb(at + 6, 1))
    if id == 0 then
        text = add_long(tree, tvb, at, size)
    else
        local action = is_return and "return" or action_of(flags, size - 8)
        local values = add_registers(tree, tvb, at + 7, size - 8, address)
        if action == "return" then
            text = string.format("%s returns %s", servo_text(id), values)
        elseif action == "read" and bit.band(flags, 0x0F) == 0x0F then
            text = string.format("read No.%d-%d of %s", address, address + length - 1,
                                 servo_text(id))
        elseif action == "read" then
            text = string.format("read %s of %s", wants[bit.band(flags, 0x0F)] or "?",
                                 servo_text(id))
        else
            text = string.format("%s %s%s%s", action, servo_text(id), values ~= "" and ": " or "",
                                 values)
        end
    end
    local sum = tree:add(fields.sum, tvb(at + size - 1, 1))
    local right = sum_of(tvb(at + 2, size - 3):raw(), 1, size - 3)
    local ok = right == tvb(at + size - 1, 1):uint()
    tree:add(fields.sum_ok, tvb(at + size - 1, 1), ok):set_generated()
    if not ok then
        sum:append_text(string.format(", should be 0x%02x", right))
        sum:add_proto_expert_info(bad_sum)
        text = text .. " [wrong sum]"
    end
    return text
end

local function add_frame(tree, tvb, frame)
    local at = frame.at - 1
    local sub = tree:add(grobo, tvb(at, frame.size))
    local text = frame.kind
    sub:add(fields.kind, tvb(at, frame.size), frame.kind):set_generated()
    if frame.kind == "relay" or frame.kind == "relay_return" then
        sub:add(fields.count, tvb(at + 1, 1))
        text = "relay"
        if frame.kind == "relay_return" then
            local last = tvb(at + frame.size - 1, 1)
            sub:add(fields.reply, last)
            text = string.format("relay, return %d", last:uint())
        end
        if not frame.packet_at then
            sub:add(fields.bytes, tvb(at + 2, frame.packet_bytes))
                :add_proto_expert_info(rubbish, "No whole packet")
            text = text .. ": no whole packet"
        end
    elseif frame.kind == "slot" or frame.kind == "scenario" then
        sub:add(fields.number, tvb(at + 2, 1))
        text = string.format("play %s %d", frame.kind, tvb(at + 2, 1):uint())
    elseif frame.kind == "rubbish" or frame.kind == "cut" then
        sub:add(fields.bytes, tvb(at, frame.size)):add_proto_expert_info(rubbish)
        text = string.format("%s: %d bytes", frame.kind, frame.size)
    elseif frame.kind == "nack" then
        sub:add_proto_expert_info(refusal)
    end
    if frame.packet_at then
        local what = add_packet(sub, tvb, at + frame.packet_at, frame.packet_bytes)
        text = (frame.kind == "packet" or frame.kind == "return") and what or text .. ": " .. what
    end
    sub:set_text(text)
    if frame.request then
        sub:add(fields.request, frame.request):set_generated()
        sub:add(fields.delay, frame.delay_ms):set_generated()
    elseif frame.unasked then
        sub:add_proto_expert_info(unasked)
    end
    return text
end

local function side_of(pinfo)
    if pinfo.p2p_dir == P2P_DIR_SENT then
        return "host"
    elseif pinfo.p2p_dir == P2P_DIR_RECV then
        return "robot"
    end
    return "unknown"
end

function grobo.dissector(tvb, pinfo, root)
    local side, number = side_of(pinfo), pinfo.number
    local chunk = tvb():raw()
    local seen = packets[number] or first_sight(number, pinfo.rel_ts, side, chunk)
    local tree = root:add(grobo, tvb(), string.format("GROBO, %s", side))
    local infos = {}
    tree:add(fields.from, side):set_generated()
    pinfo.cols.protocol = "GROBO"
    if side ~= "unknown" then
        pinfo.cols.src = side
        pinfo.cols.dst = side == "host" and "robot" or "host"
    end
    if seen.before then
        local before = ByteArray.new(seen.before, true):tvb("Earlier packets, never completed")
        for _, frame in ipairs(seen.before_frames) do
            table.insert(infos, "earlier " .. add_frame(tree, before, frame))
        end
    end
    local whole = tvb
    if #seen.prefix > 0 then
        whole = ByteArray.new(seen.prefix .. chunk, true):tvb("With the packets before")
    end
    for _, frame in ipairs(seen.frames) do
        table.insert(infos, add_frame(tree, whole, frame))
    end
    if seen.continued then
        tree:add(fields.continued, seen.continued):set_generated()
    end
    if answered[number] then
        tree:add(fields.answer, answered[number]):set_generated()
    end
    if #infos == 0 then
        table.insert(infos, seen.continued and "goes on in packet " .. seen.continued or
                         "begins a frame")
    end
    pinfo.cols.info = table.concat(infos, "; ")
end

DissectorTable.get("wtap_encap"):add((wtap_encaps or wtap).USER0, grobo)
