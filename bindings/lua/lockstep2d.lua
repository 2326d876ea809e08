--- The flat API of lockstep2d for LuaJIT and LÖVE. Names are those of lockstep2d.h without the prefix `ls2d_` or
--- `LS2D_`: `ls.world_step(world)`, `ls.DYNAMIC`. The header and the library have to be in the folder of this file or
--- of the LÖVE game. The library may also be on the search path of the system.
---
--- A function that returns a status in C raises an error if it fails. Otherwise it returns true for `LS2D_OK`, and
--- false for `LS2D_NONE` (nothing to return). Other functions return their result.
---
--- Numbers that enter the state are fixed-point integers, made by `ls.fx`. Lua's own numbers are floats: use them only
--- for drawing.
local ffi = require("ffi")

local ls = {}

-- Folder of this file. Under LÖVE, it is relative to the folder of the game.
local folder = debug.getinfo(1, "S").source:match("^@(.*)lockstep2d%.lua$") or ""
local folders = { folder == "" and "./" or folder }
if love then
    local game = love.filesystem.getSource() .. "/"
    folders = { game .. folder, game, folders[1] }
end

local function read_header()
    local name = "lockstep2d.h"
    -- The folder of the game may be an archive, which only LÖVE can read.
    for _, path in ipairs(love and { folder .. name, name } or {}) do
        if love.filesystem.getInfo(path) then
            return (assert(love.filesystem.read(path)))
        end
    end
    local file = assert(io.open(folders[#folders] .. name))
    local text = file:read("*a")
    file:close()
    return text
end

local function load_library()
    local names = { Windows = "lockstep2d_flat.dll", OSX = "liblockstep2d_flat.dylib" }
    local name = names[ffi.os] or "liblockstep2d_flat.so"
    for _, each in ipairs(folders) do
        -- The path has a slash. Otherwise `ffi.load` would look for the file on the search path of the system.
        local path = each .. name
        local file = io.open(path)
        if file then
            file:close()
            return ffi.load(path)
        end
    end
    return ffi.load("lockstep2d_flat")
end

local header = read_header()
for name, value in header:gmatch("\n#define LS2D_([%u%d_]+) ([%w_]+)") do
    ls[name] = value == "UINT64_MAX" and 0xffffffffffffffffULL or tonumber(value)
end
local returns_status = {}
for name in header:gmatch("\nls2d_status (ls2d_[%w_]+)%(") do
    returns_status[name] = true
end
-- For each function with arguments of type `ls2d_fx`, the list of the positions of these arguments.
local fx_positions = {}
for name, parameters in header:gmatch("\n[%w_]+ (ls2d_[%w_]+)%(([^()]*)%);") do
    local position, found = 0, {}
    for parameter in parameters:gmatch("[^,]+") do
        position = position + 1
        if parameter:match("^%s*ls2d_fx [%w_]+$") then
            found[#found + 1] = position
        end
    end
    fx_positions[name] = found[1] and found
end
-- Removes comments and directives, because `ffi.cdef` has no preprocessor.
ffi.cdef((header:gsub("/%*.-%*/", ""):gsub("#ifdef __cplusplus.-#endif", ""):gsub("\n#[^\n]*", "")))
local C = load_library()
assert(C.ls2d_api_version() == ls.API_VERSION, "lockstep2d.h and the library have different versions")

local function last_error()
    local text, length = ffi.new("uint8_t[256]"), ffi.new("size_t[1]")
    C.ls2d_last_error(text, 256, length)
    return ffi.string(text, math.min(256, tonumber(length[0])))
end

--- Makes a function refuse Lua numbers as arguments of type `ls2d_fx`, because LuaJIT would convert them to raw
--- integers. The Lua number 0 is allowed, because the fixed-point number 0 also has the raw integer 0.
local function refuse_numbers(name, raw)
    local positions = fx_positions[name]
    return not positions and raw or function(...)
        for _, position in ipairs(positions) do
            local given = select(position, ...)
            if type(given) == "number" and given ~= 0 then
                local text = "%s: argument %d is the Lua number %s: pass ls.fx(...)"
                error(text:format(name, position, given), 3)
            end
        end
        return raw(...)
    end
end

local function wrap(name)
    local raw = refuse_numbers(name, C[name])
    if not returns_status[name] then
        return raw
    end
    return function(...)
        local status = raw(...)
        if status == ls.OK or status == ls.NONE then
            return status == ls.OK
        end
        error(("%s: %s (status %d)"):format(name, last_error(), status), 2)
    end
end

setmetatable(ls, {
    __index = function(self, key)
        local found, value = pcall(wrap, "ls2d_" .. key)
        if not found then
            error("lockstep2d has no " .. tostring(key), 2)
        end
        self[key] = value
        return value
    end,
})

--- A struct with its defaults: `ls.make("body_def", ls.DYNAMIC)` calls `ls2d_body_def_init`.
function ls.make(struct, ...)
    local made = ffi.new("ls2d_" .. struct)
    local arguments = { ... }
    arguments[#arguments + 1] = made
    ls[struct .. "_init"](unpack(arguments))
    return made
end

--- Memory for a result, which is at index 0: `ls.out("handle")`, `ls.out("body")`.
function ls.out(type)
    return ffi.new("ls2d_" .. type .. "[1]")
end

--- A fixed-point number from a whole number or decimal text: `ls.fx(3)`, `ls.fx("0.25")`.
function ls.fx(value)
    if type(value) == "string" then
        local number = ls.out("fx")
        ls.fx_parse(value, #value, number)
        return number[0]
    end
    if type(value) ~= "number" or value % 1 ~= 0 then
        error("a number with a fraction enters the state as text: fx(\"0.25\"), not fx(0.25)", 2)
    end
    if value < -2147483648 or value >= 2147483648 then
        error("a number is from -2^31 to below 2^31, and not " .. value, 2)
    end
    return ffi.new("int64_t", value) * 4294967296LL
end

--- Converts a fixed-point number to a Lua number, for drawing.
function ls.number(fx)
    return tonumber(fx) / 4294967296
end

local function copied(handle)
    local size = ffi.new("size_t[1]")
    ls.bytes_size(handle, size)
    local buffer = ffi.new("uint8_t[?]", math.max(1, tonumber(size[0])))
    ls.bytes_copy(handle, buffer, size[0])
    return ffi.string(buffer, size[0])
end

--- The contents of a bytes object as a string. Frees the object, also if there is no memory for the string.
function ls.take_bytes(handle)
    local done, result = pcall(copied, handle)
    C.ls2d_free(handle)
    return done and result or error(result, 2)
end

--- A hash as 32 hexadecimal digits.
function ls.hex(hash)
    return bit.tohex(hash.high, 16) .. bit.tohex(hash.low, 16)
end

return ls
