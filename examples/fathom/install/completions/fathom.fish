# SPDX-License-Identifier: MIT
function __fathom
    set -l words (commandline -opc) (commandline -ct)
    for line in (fathom complete $words[2..-1] 2>/dev/null)
        switch $line
            case :files
                set -l parts (string match -r -- '^(--[^=]*=)?(.*)$' (commandline -ct))
                for path in (__fish_complete_path $parts[-1])
                    test (count $parts) -eq 3; and echo $parts[2]$path; or echo $path
                end
            case '*'
                echo $line
        end
    end
end
complete -c fathom -f -a '(__fathom)'
