--- Misuse of the API raises errors with an explanation.
local ls = require("lockstep2d")

local function fails(what, pattern, action, ...)
    local ok, message = pcall(action, ...)
    assert(not ok, what .. " should fail")
    assert(tostring(message):match(pattern), ("%s: %s"):format(what, message))
end

local out = ls.out("handle")
ls.world_new(nil, out)
local world = out[0]

fails("a fraction", "as text", ls.fx, 0.25)
fails("a text that is no number", "ls2d_fx_parse", ls.fx, "a quarter")
fails("an unknown function", "has no frobnicate", function() return ls.frobnicate end)
fails("a null pointer", "ls2d_world_new", ls.world_new, nil, nil)
fails("a wrong handle", "status " .. ls.HANDLE, ls.world_step, 12345)
fails("a handle of another kind", "status " .. ls.HANDLE_KIND, ls.match_leave, world)
fails("a wrong size", "status " .. ls.SIZE, function()
    local def = ls.make("body_def", ls.DYNAMIC)
    def.size = 1
    ls.spawn(world, def, nil, 0, nil)
end)
fails("a Lua number for a fixed-point number", "argument 3 is the Lua number %-10", ls.set_gravity, world, 0, -10)
fails("a Lua number for a sine", "argument 1 is the Lua number 0.5", ls.fx_add, 0.5, ls.fx(1))
assert(ls.set_gravity(world, 0, ls.fx(-10)) and ls.fx_add(ls.fx(1), 0) == ls.fx(1), "0 is 0 in both")
ls.free(world)
fails("a freed world", "status " .. ls.HANDLE, ls.world_step, world)
assert(tonumber(ls.object_count()) == 0, "nothing is leaked")
-- If there is no memory for the string, `take_bytes` still frees the bytes object.
local ffi = require("ffi")
ls.bytes_new("abc", 3, out)
local new = ffi.new
ffi.new = function(type, ...)
    assert(type ~= "uint8_t[?]", "not enough memory")
    return new(type, ...)
end
fails("a copy without memory", "not enough memory", ls.take_bytes, out[0])
ffi.new = new
assert(tonumber(ls.object_count()) == 0, "the bytes are leaked")
assert(ls.fx("0.25") == ls.fx(1) / 4 and ls.number(ls.fx("-1.5")) == -1.5)
assert(ls.cast_ray ~= nil and ls.NO_ID == 0xffffffffffffffffULL)
print("misuse: every mistake is an error")
